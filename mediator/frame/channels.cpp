#include "mediator/frame/channels.h"

#include "mediator/base/old_names.h"

namespace tessera::frame {

std::optional<Channel> channel_by_name(std::string_view name) {
    const std::string_view present = present_name("channel", name).value_or(name);
    for (const ChannelInfo& entry : ChannelTable) {
        if (entry.name == present) return entry.channel;
    }
    return std::nullopt;
}

std::uint32_t ChannelSet::plane_count() const {
    std::uint32_t count = 0;
    for (const ChannelInfo& entry : ChannelTable) count += contains(entry.channel) ? entry.plane_count() : 0;
    return count;
}

std::uint32_t ChannelSet::first_plane(Channel channel) const {
    std::uint32_t first = 0;
    for (const ChannelInfo& entry : ChannelTable) {
        if (entry.channel == channel) break;
        first += contains(entry.channel) ? entry.plane_count() : 0;
    }
    return first;
}

}  // namespace tessera::frame
