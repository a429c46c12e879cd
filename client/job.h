#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mediator/base/clock.h"
#include "mediator/base/ids.h"
#include "mediator/frame/film_tile.h"
#include "mediator/view/view.h"
#include "mediator/wire/display_messages.h"
#include "mediator/wire/live_messages.h"

// What a client asks of a cluster and hears back, as plain values.
namespace tessera::client {

enum class Policy : std::uint8_t { Tiled, Cooperative, Mixed };

enum class PictureEncoding : std::uint8_t { None, Planes, Png, Jpeg, Exr };

struct JobRequest {
    view::View view;  // id and revision are the master's to choose
    std::uint64_t spp = 64;
    Duration time_limit{0};  // 0 = spp decides; else as many samples as fit
    Policy policy = Policy::Mixed;
    bool reproducible = false;     // only nodes pinned to AVX2
    std::uint32_t wait_nodes = 1;  // begin when so many are ready
    Duration wait_limit = std::chrono::seconds(60);
    PictureEncoding picture = PictureEncoding::None;  // what the master makes of the film with view.filter
    bool film = true;                                 // the statistics, too
    Duration budget{0};  // not 0: the picture is there so long after the start, filter and encoding included
    bool adapts_size =
        false;  // with a budget that is too small for 2 samples per pixel: half or a quarter of the size
};

enum class Phase : std::uint8_t { WaitingForNodes, Syncing, Rendering, Delivering, Filtering };
struct Progress {
    Phase phase = Phase::WaitingForNodes;
    std::uint64_t samples = 0, samples_expected = 0;  // of pixels
    std::uint64_t rays = 0;
    std::uint32_t nodes = 0;
    Duration elapsed{};  // since rendering began
};

enum class Outcome : std::uint8_t { Complete, TimeUp, Stopped, NoNodes, Failed };

struct NodeShare {
    std::uint64_t id = 0;
    std::string name, host, backend, kind;
    std::uint64_t pid = 0, units = 0, samples = 0;
    double seconds_busy = 0;
};
struct UnitCounts {
    std::uint64_t issued = 0, reissued = 0, merged = 0, duplicate = 0, cancelled = 0, refused = 0, lost = 0;
};
struct WireBytes {
    std::uint64_t control = 0, blobs = 0, film = 0;
};

struct FilterPass {
    std::string name;
    double seconds = 0, bytes_per_pixel = 0;
};
// Made by the master. Planes: float32, one component after another, each in raster order; otherwise a file.
struct Picture {
    PictureEncoding encoding = PictureEncoding::None;
    std::uint32_t width = 0, height = 0, components = 0;
    std::vector<std::byte> bytes;
    std::string filter;       // as it ran: name and values
    std::uint32_t scale = 1;  // 2, 4: rendered at this part of the size and upsampled
    double seconds_filter = 0, seconds_encode = 0;
    double seconds_predicted = 0;  // with a budget: what was set aside for filter and encoding
    std::vector<FilterPass> passes;
    std::vector<std::string> notes;
};

struct JobResult {
    Outcome outcome = Outcome::Complete;
    std::string message;  // why, unless complete
    // The whole window; pixels without samples have count 0. Empty when nothing was rendered.
    std::optional<frame::FilmTile> film;
    std::optional<Picture> picture;                     // as asked for
    std::uint64_t samples_least = 0, samples_most = 0;  // of a pixel; with a picture
    Version version;
    double seconds_render = 0, first_picture_seconds = 0;
    std::uint64_t rays = 0, samples = 0, nonfinite_samples = 0;
    std::uint64_t triangles = 0, instances = 0, lights = 0;
    std::vector<NodeShare> nodes;
    UnitCounts units;
    WireBytes wire_bytes;
};

struct NodeState {
    NodeShare share;
    std::string phase;  // "idle", "syncing", "building", "rendering", "leaving"
    Version version;
    std::uint32_t units_in_hand = 0;
    double samples_per_second = 0, round_trip_seconds = 0;
    bool stuck = false;
    double clock_offset_seconds = 0,
           clock_bound_seconds = 0;  // its clock less the master's, +- bound; bound 0 = not known yet
};
struct ClusterStatus {
    std::string software;
    Version version;
    double uptime_seconds = 0;
    std::uint64_t blobs = 0, blob_bytes = 0;
    std::uint32_t sessions = 0, queued = 0;
    std::uint64_t dropped_messages = 0;
    UnitCounts units;
    WireBytes wire_bytes;
    std::vector<NodeState> nodes;
    wire::LiveStatus live;
    std::uint64_t resyncs = 0;  // nodes that had to be sent the whole scene again
    wire::DisplayStatus display;
};

}  // namespace tessera::client
