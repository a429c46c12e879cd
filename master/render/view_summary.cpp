#include "master/render/view_summary.h"

#include <algorithm>

#include "mediator/wire/envelope.h"

namespace tessera::master {

bool has_picture(const ViewState& view, session::PictureEncoding wanted) {
    return wanted != session::PictureEncoding::None && view.run.samples > 0 && view.is_last_pass();
}

session::ViewProgress progress_of(const ViewState& view, std::uint32_t nodes) {
    session::ViewProgress progress{
        .phase = view.run.phase, .rays = view.run.rays, .nodes = nodes, .elapsed = {}};
    const view::View& last = view.passes.empty() ? view.request.view : view.passes.back().view;
    progress.samples = view.run.samples;
    progress.samples_expected = last.window.pixel_count() * view.request.stop.max_samples();
    if (!view.passes.empty()) progress.elapsed = view.run.seen_at - view.run.rendering_since;
    return progress;
}

session::ViewSummary summary_of(const ViewState& view, const SceneFacts& facts,
                                const session::WireBytes& bytes) {
    const Run& run = view.run;
    session::ViewSummary done{.outcome = *run.outcome,
                              .message = run.message,
                              .version = view.version,
                              .seed = view.request.view.seed,
                              .rays = run.rays,
                              .nonfinite_samples = run.nonfinite_samples,
                              .triangles = facts.triangles,
                              .instances = facts.instances,
                              .lights = facts.lights};
    if (!view.passes.empty()) {
        done.seconds_render = seconds(*run.ended - run.rendering_since);
        done.samples = run.samples;
        done.units = run.units;
    }
    if (run.first_picture) done.first_picture_seconds = seconds(*run.first_picture - run.started);
    for (const auto& [id, node] : run.nodes) done.nodes.push_back(node);
    done.wire_bytes = {.control = bytes.control - run.bytes_before.control,
                       .blobs = bytes.blobs - run.bytes_before.blobs,
                       .film = bytes.film - run.bytes_before.film};
    return done;
}

net::Bytes encoded(wire::ViewDone done) {
    net::Bytes message = wire::encode(wire::ControlMessage(done));
    std::vector<session::NodeSummary>& nodes = done.summary.nodes;
    const std::size_t all = nodes.size();
    std::ranges::stable_sort(nodes, std::greater<>(), &session::NodeSummary::samples);
    std::vector<std::string>& notes = done.summary.picture.notes;
    notes.emplace_back();
    while (!wire::fits_control(message) && !nodes.empty()) {
        nodes.resize(nodes.size() / 2);
        notes.back() =
            std::to_string(all - nodes.size()) + " of " + std::to_string(all) + " nodes are not listed";
        message = wire::encode(wire::ControlMessage(done));
    }
    return message;
}

void describe(const ViewState& view, session::PictureSummary& picture) {
    picture.seconds_predicted = view.run.predicted_seconds;
    picture.scale = view.run.scale;
    if (view.run.scale == 1) return;
    picture.notes.push_back("the time is too short for 2 samples in every pixel: rendered at 1/" +
                            std::to_string(view.run.scale) + " of the size and upsampled");
}

}  // namespace tessera::master
