#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "mediator/base/clock.h"
#include "mediator/base/hash.h"
#include "mediator/base/ids.h"
#include "mediator/base/rect.h"
#include "mediator/session/view_request.h"

// Progress and result of a view.
namespace tessera::session {

enum class Phase : std::uint8_t { WaitingForNodes, Syncing, Rendering, Delivering, Filtering };
constexpr auto enumerators(Phase) {
    return std::to_array<std::string_view>(
        {"waiting_for_nodes", "syncing", "rendering", "delivering", "filtering"});
}
struct ViewProgress {
    Phase phase = Phase::WaitingForNodes;
    std::uint64_t samples = 0, samples_expected = 0;  // pixel samples
    std::uint64_t rays = 0;
    std::uint32_t nodes = 0;
    Duration elapsed{};  // since rendering began
    double noise = 0.0;  // of an adaptive picture, at the last decision: sqrt(relMSE); 0: unknown
    std::uint64_t samples_before = 0;  // of `samples`, those of the film that it continues
    double error = 0.0;  // estimated relMSE of the filtered picture, likewise, if the view stops at an error
    static constexpr auto describe(auto row) {
        using Self = ViewProgress;
        return std::tuple(row(1, "phase", &Self::phase), row(2, "samples", &Self::samples),
                          row(3, "samples_expected", &Self::samples_expected), row(4, "rays", &Self::rays),
                          row(5, "nodes", &Self::nodes), row(6, "elapsed", &Self::elapsed),
                          row(7, "noise", &Self::noise), row(8, "samples_before", &Self::samples_before),
                          row(9, "error", &Self::error));
    }
};

enum class Outcome : std::uint8_t {
    Complete,
    TimeUp,
    Stopped,
    NoNodes,
    Failed,
    Incomplete  // complete but for tiles that no node could render
};
constexpr auto enumerators(Outcome) {
    return std::to_array<std::string_view>(
        {"complete", "time_up", "stopped", "no_nodes", "failed", "incomplete"});
}

struct NodeSummary {
    NodeId id;
    std::string name, host, backend, kind;
    std::uint64_t pid = 0, units = 0, samples = 0;
    double seconds_busy = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "id", &NodeSummary::id), row(2, "name", &NodeSummary::name),
                          row(3, "host", &NodeSummary::host), row(4, "backend", &NodeSummary::backend),
                          row(5, "kind", &NodeSummary::kind), row(6, "pid", &NodeSummary::pid),
                          row(7, "units", &NodeSummary::units), row(8, "samples", &NodeSummary::samples),
                          row(9, "seconds_busy", &NodeSummary::seconds_busy));
    }
};
struct UnitCounts {
    std::uint64_t issued = 0, reissued = 0, merged = 0, duplicate = 0, cancelled = 0, refused = 0, lost = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "issued", &UnitCounts::issued), row(2, "reissued", &UnitCounts::reissued),
                          row(3, "merged", &UnitCounts::merged), row(4, "duplicate", &UnitCounts::duplicate),
                          row(5, "cancelled", &UnitCounts::cancelled),
                          row(6, "refused", &UnitCounts::refused), row(7, "lost", &UnitCounts::lost));
    }
};
struct WireBytes {
    std::uint64_t control = 0, blobs = 0, film = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "control", &WireBytes::control), row(2, "blobs", &WireBytes::blobs),
                          row(3, "film", &WireBytes::film));
    }
};
struct FilterPass {
    std::string name;
    double seconds = 0, bytes_per_pixel = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "name", &FilterPass::name), row(2, "seconds", &FilterPass::seconds),
                          row(3, "bytes_per_pixel", &FilterPass::bytes_per_pixel));
    }
};
// The picture of a frame.
struct PictureSummary {
    PictureEncoding encoding = PictureEncoding::None;
    std::uint32_t width = 0, height = 0, components = 0;
    std::uint64_t byte_size = 0;
    std::string filter;       // name and parameters as used
    std::uint32_t scale = 1;  // 2, 4: rendered at 1/2, 1/4 of the size and upsampled
    double seconds_filter = 0, seconds_encode = 0;
    double seconds_predicted = 0;  // with a budget: time reserved for filter and encoding
    std::vector<FilterPass> passes;
    std::vector<std::string> notes;            // readable messages
    view::DisplayTransform display_transform;  // of a PNG or JPEG, with the exposure that was used
    static constexpr auto describe(auto row) {
        using Self = PictureSummary;
        return std::tuple(
            row(1, "encoding", &Self::encoding, UpTo{PictureEncoding::Exr}), row(2, "width", &Self::width),
            row(3, "height", &Self::height), row(4, "components", &Self::components),
            row(5, "byte_size", &Self::byte_size), row(6, "filter", &Self::filter),
            row(7, "scale", &Self::scale), row(8, "seconds_filter", &Self::seconds_filter),
            row(9, "seconds_encode", &Self::seconds_encode),
            row(10, "seconds_predicted", &Self::seconds_predicted), row(11, "passes", &Self::passes),
            row(12, "notes", &Self::notes), row(13, "display_transform", &Self::display_transform));
    }
};

// A tile of the picture that no node could render, or only with fewer samples.
struct FailedTile {
    Rect rect;                  // of the picture
    std::uint64_t samples = 0;  // per pixel that it has
    std::string message;        // the failure, with the command that replays it
    static constexpr auto describe(auto row) {
        using Self = FailedTile;
        return std::tuple(row(1, "rect", &Self::rect), row(2, "samples", &Self::samples),
                          row(3, "message", &Self::message));
    }
};
inline constexpr std::size_t MaxFailedTiles = 64;

// The result of a view after its stop rule ended it.
struct ViewSummary {
    Outcome outcome = Outcome::Complete;
    std::string message;  // why, unless complete
    Version version;
    std::uint64_t seed = 0;
    double seconds_render = 0, first_picture_seconds = 0;
    std::uint64_t rays = 0, samples = 0, nonfinite_samples = 0;
    std::uint64_t triangles = 0, instances = 0, lights = 0;
    std::vector<NodeSummary> nodes;
    UnitCounts units;
    WireBytes wire_bytes;
    PictureSummary picture;
    std::uint64_t min_samples = 0, max_samples = 0;  // per pixel; with a picture
    std::vector<FailedTile> failed_tiles;            // the first ones
    double noise = 0.0;                              // as in ViewProgress
    std::uint64_t samples_before = 0;                // likewise
    std::uint32_t steps = 0;                         // of an adaptive picture: decided ones
    Hash128 scene_hash;                              // of the scene in the film
    double error = 0.0;                              // as in ViewProgress
    static constexpr auto describe(auto row) {
        using Self = ViewSummary;
        return std::tuple(
            row(1, "outcome", &Self::outcome), row(2, "message", &Self::message),
            row(3, "version", &Self::version), row(4, "seed", &Self::seed),
            row(5, "seconds_render", &Self::seconds_render),
            row(6, "first_picture_seconds", &Self::first_picture_seconds), row(7, "rays", &Self::rays),
            row(8, "samples", &Self::samples), row(9, "nonfinite_samples", &Self::nonfinite_samples),
            row(10, "triangles", &Self::triangles), row(11, "instances", &Self::instances),
            row(12, "lights", &Self::lights), row(13, "nodes", &Self::nodes), row(14, "units", &Self::units),
            row(15, "wire_bytes", &Self::wire_bytes), row(16, "picture", &Self::picture),
            row(17, "min_samples", &Self::min_samples), row(18, "max_samples", &Self::max_samples),
            row(19, "failed_tiles", &Self::failed_tiles, Limit{MaxFailedTiles}),
            row(20, "noise", &Self::noise), row(21, "samples_before", &Self::samples_before),
            row(22, "steps", &Self::steps), row(23, "scene_hash", &Self::scene_hash),
            row(24, "error", &Self::error));
    }
};

}  // namespace tessera::session
