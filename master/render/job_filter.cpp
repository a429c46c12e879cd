// Another filter while a frame is being rendered.
#include "master/filter/catalog.h"
#include "master/render/job_runner.h"
#include "mediator/filter/choice.h"

namespace tessera::master {

namespace {

wire::FilterSet no(std::string why) {
    return {.accepted = false, .text = std::move(why)};
}

std::string names(frame::ChannelSet channels) {
    std::string text;
    for (const frame::ChannelInfo& entry : frame::channel_table()) {
        if (channels.contains(entry.channel)) text += (text.empty() ? "" : ", ") + std::string(entry.name);
    }
    return text;
}

}  // namespace

wire::FilterSet JobRunner::set_filter(const std::string& filter, TimePoint now) {
    const auto choice = filter::parse_choice(filter, filter::catalog());
    if (!choice) return no(choice.error().what());
    if (!job_ || job_->outcome || job_->stage) return no("no frame is being rendered: try again when one is");
    wire::StartJob& request = job_->request;
    if (request.picture == wire::PictureEncoding::None) {
        return no(
            "the frame's client asked for the film alone: nothing would be filtered; start it with --filter");
    }
    const filter::Description& description = choice->entry->description;
    view::View wanted = request.view;
    wanted.filter = filter::to_text(*choice);
    complete(wanted);
    if (wanted.path_class != request.view.path_class) {
        return no("filter '" + std::string(description.name) +
                  "' works on other paths than this frame tells apart: start the frame with it");
    }
    const auto added = frame::ChannelSet::from_bits(wanted.channels.bits() & ~request.view.channels.bits());
    if (added.contains(frame::Channel::Radiance)) {
        return no(
            "filter '" + std::string(description.name) +
            "' reads the variance of the light, and this frame keeps color alone: start the frame with it");
    }
    if (added.empty() || !job_->rendering()) {
        request.view.filter = wanted.filter;
        request.view.channels = wanted.channels;
        return {.accepted = true, .text = "filter " + wanted.filter + " for the whole frame"};
    }
    // All that is in the nodes' hands lacks the channels: it is dealt again under a new revision.
    ++wanted.revision;
    request.view = wanted;
    cancel(job_->scheduler->revise(wanted.revision));
    merger_.widen(wanted.id, wanted.revision, wanted.channels);
    deal(now);
    return {
        .accepted = true,
        .text = "filter " + wanted.filter + "; " + names(added) + " from now on, not of the samples before"};
}

}  // namespace tessera::master
