#include "mediator/frame/channels.h"

namespace tessera::frame {

namespace {

constexpr std::array<ChannelInfo, ChannelCount> Table{{
    {Channel::Radiance, "radiance", MergeRule::Moments, 3},
    {Channel::LowVariance, "low_variance", MergeRule::Moments, 3},
    {Channel::HighVariance, "high_variance", MergeRule::Moments, 3},
    {Channel::Albedo, "albedo", MergeRule::Sum, 3},
    {Channel::Normal, "normal", MergeRule::Sum, 3},
    {Channel::Depth, "depth", MergeRule::Minimum, 1},
    {Channel::ObjectIndex, "object_id", MergeRule::Nearest, 2},
    {Channel::Alpha, "alpha", MergeRule::Sum, 1},
    {Channel::Range, "range", MergeRule::Sum, 3},
    {Channel::ShadingFeature, "shading", MergeRule::Moments, 1},
    {Channel::Irradiance, "irradiance", MergeRule::Moments, 3},
    {Channel::EvenHalf, "even_half", MergeRule::Sum, 4},
    {Channel::Color, "color", MergeRule::Sum, 3},
}};

}  // namespace

std::span<const ChannelInfo, ChannelCount> channel_table() {
    return Table;
}

const ChannelInfo& info(Channel channel) {
    return Table[static_cast<std::size_t>(channel)];
}

std::optional<Channel> channel_by_name(std::string_view name) {
    for (const ChannelInfo& entry : Table) {
        if (entry.name == name) return entry.channel;
    }
    return std::nullopt;
}

std::uint32_t ChannelSet::plane_count() const {
    std::uint32_t count = 0;
    for (const ChannelInfo& entry : Table) count += contains(entry.channel) ? entry.plane_count() : 0;
    return count;
}

std::uint32_t ChannelSet::first_plane(Channel channel) const {
    std::uint32_t first = 0;
    for (const ChannelInfo& entry : Table) {
        if (entry.channel == channel) break;
        first += contains(entry.channel) ? entry.plane_count() : 0;
    }
    return first;
}

}  // namespace tessera::frame
