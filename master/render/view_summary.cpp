#include "master/render/view_summary.h"

#include <algorithm>

#include "mediator/wire/envelope.h"

namespace tessera::master {

Rect in_full_size(const ViewState& view, const Pass& pass, const Rect& rect) {
    const std::uint32_t scale = pass.kind == Pass::Kind::Coarse    ? pass.scale
                                : pass.kind == Pass::Kind::Picture ? view.run.scale
                                                                   : 1;
    if (scale == 1) return rect;
    const Rect& window = view.request.view.window;  // the windows of scaled views begin at 0
    const auto factor = static_cast<std::int32_t>(scale);
    return intersection(
        {window.x + factor * rect.x, window.y + factor * rect.y, factor * rect.width, factor * rect.height},
        window);
}

std::string failed_tiles_text(const ViewState& view) {
    const std::size_t count = view.failed_tiles.size();
    return std::to_string(count) + (count == 1 ? " tile" : " tiles") +
           " could not be rendered by any node that tried: " + view.failed_tiles.front().message;
}

bool has_picture(const ViewState& view, session::PictureEncoding wanted) {
    return wanted != session::PictureEncoding::None && view.run.samples > 0 && view.is_last_pass();
}

session::ViewProgress progress_of(const ViewState& view, std::uint32_t nodes) {
    session::ViewProgress progress{
        .phase = view.run.phase, .rays = view.run.rays, .nodes = nodes, .elapsed = {}};
    const view::View& last = view.passes.empty() ? view.request.view : view.passes.back().view;
    progress.samples = view.run.samples;
    const std::uint64_t pixels = last.window.pixel_count();
    progress.samples_expected = pixels * view.request.stop.spp;
    if (view.request.has_steps())
        progress.samples_expected =
            std::max(view.run.samples_expected, pixels * session::StopRule::AdaptiveBase);
    progress.noise = view.run.noise;
    progress.error = view.run.error;
    progress.samples_before = view.run.samples_before;
    if (!view.passes.empty()) progress.elapsed = view.run.seen_at - view.run.rendering_since;
    return progress;
}

session::ViewSummary summary_of(const ViewState& view, const SceneFacts& facts,
                                const session::WireBytes& bytes) {
    const Run& run = view.run;
    session::ViewSummary done{
        .outcome = *run.outcome,
        .message = run.message,
        .version = view.version,
        .seed = view.passes.empty() ? view.request.view.seed : view.passes.back().view.seed,
        .rays = run.rays,
        .nonfinite_samples = run.nonfinite_samples,
        .triangles = facts.triangles,
        .instances = facts.instances,
        .lights = facts.lights,
        .noise = run.noise,
        .samples_before = run.samples_before,
        .steps = run.steps,
        .scene_hash = view.scene_hash,
        .error = run.error};
    if (!view.passes.empty()) {
        done.seconds_render = seconds(*run.ended - run.rendering_since);
        done.samples = run.samples;
        done.units = run.units;
    }
    if (run.first_picture) done.first_picture_seconds = seconds(*run.first_picture - run.started);
    for (const auto& [id, node] : run.nodes) done.nodes.push_back(node);
    for (const session::FailedTile& tile : view.failed_tiles) {
        constexpr std::size_t MaxMessages = 8, MaxLength = 400;  // the others fail alike
        if (done.failed_tiles.size() == session::MaxFailedTiles) break;
        done.failed_tiles.push_back(tile);
        std::string& message = done.failed_tiles.back().message;
        message.resize(done.failed_tiles.size() > MaxMessages ? 0 : std::min(message.size(), MaxLength));
    }
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
    constexpr std::size_t MaxLeftOut = 8;
    const std::vector<std::string>& left_out = view.run.left_out;
    picture.notes.insert(
        picture.notes.end(), left_out.begin(),
        left_out.begin() + static_cast<std::ptrdiff_t>(std::min(left_out.size(), MaxLeftOut)));
    if (left_out.size() > MaxLeftOut)
        picture.notes.push_back(std::to_string(left_out.size() - MaxLeftOut) + " more nodes take no part");
    if (view.run.scale == 1) return;
    picture.notes.push_back("the time is too short for 2 samples in every pixel: rendered at 1/" +
                            std::to_string(view.run.scale) + " of the size and upsampled");
}

}  // namespace tessera::master
