#include "master/render/filter_change.h"

#include "master/filter/catalog.h"
#include "master/render/view_request.h"
#include "mediator/filter/choice.h"

namespace tessera::master {

std::string channel_names(frame::ChannelSet channels) {
    std::string text;
    for (const frame::ChannelInfo& entry : frame::channel_table()) {
        if (channels.contains(entry.channel)) text += (text.empty() ? "" : ", ") + std::string(entry.name);
    }
    return text;
}

FilterChange filter_change(const view::View& now, const std::string& filter) {
    using Effect = FilterChange::Effect;
    const auto choice = filter::parse_choice(filter, filter::catalog());
    const std::string name(choice->entry->description.name);
    FilterChange change{.view = now, .text = {}};
    change.view.filter = filter::to_text(*choice);
    complete(change.view);
    const auto added = change.view.channels - now.channels;
    if (change.view.path_class != now.path_class) {
        change.effect = Effect::Restarted;
        change.text = "filter '" + name +
                      "' needs path classes that this frame does not separate: start the frame with it";
    } else if (added.contains(frame::Channel::Radiance)) {
        change.effect = Effect::Restarted;
        change.text = "filter '" + name +
                      "' needs the variance of the radiance, but this frame has only color: start the frame "
                      "with it";
    } else if (added.empty()) {
        change.text = "filter " + change.view.filter + " for the whole frame";
    } else {
        change.effect = Effect::Widened;
        change.text = "filter " + change.view.filter + "; " + channel_names(added) + " from now on";
    }
    return change;
}

}  // namespace tessera::master
