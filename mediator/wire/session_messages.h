#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "mediator/wire/display_messages.h"
#include "mediator/wire/live_messages.h"
#include "mediator/wire/peer_messages.h"

// What clients and the master say to each other about batches, edits and the state of all.
namespace tessera::wire {

// Asks for the stage: one batch scene at a time. Answered by QueuePlace until SceneOpened (or Refusal with
// no_wait).
struct OpenScene {
    std::string title;
    bool no_wait = false;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "title", &OpenScene::title), row(2, "no_wait", &OpenScene::no_wait));
    }
};
struct QueuePlace {
    std::uint32_t place = 0;  // 1 = next
    static constexpr auto describe(auto row) { return std::tuple(row(1, "place", &QueuePlace::place)); }
};
struct SceneOpened {
    Version version;
    std::uint64_t first_id = 0, id_count = 0;  // lent to this session for new objects
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "version", &SceneOpened::version),
                          row(2, "first_id", &SceneOpened::first_id),
                          row(3, "id_count", &SceneOpened::id_count));
    }
};
struct SubmitEdit {
    scene::Edit edit;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "edit", &SubmitEdit::edit)); }
};
struct SubmitEditByBlob {
    SessionId session;
    std::uint64_t sequence = 0;
    Version base;
    scene::BlobRef blob;  // an encoded Edit
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "session", &SubmitEditByBlob::session),
                          row(2, "sequence", &SubmitEditByBlob::sequence),
                          row(3, "base", &SubmitEditByBlob::base), row(4, "blob", &SubmitEditByBlob::blob));
    }
};
struct EditReply {
    std::uint64_t sequence = 0;
    bool accepted = false;
    Version version;                    // that holds it, or will when it is published
    std::vector<std::string> problems;  // why not
    std::uint64_t transaction = 0;      // that it is, or is part of
    std::vector<std::string> notes;     // of an undo: what was left as later edits made it
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "sequence", &EditReply::sequence), row(2, "accepted", &EditReply::accepted),
                          row(3, "version", &EditReply::version), row(4, "problems", &EditReply::problems),
                          row(5, "transaction", &EditReply::transaction), row(6, "notes", &EditReply::notes));
    }
};

enum class Policy : std::uint8_t { Tiled, Cooperative, Mixed };
constexpr auto enumerators(Policy) {
    return std::to_array<std::string_view>({"tiled", "cooperative", "mixed"});
}
struct StartJob {
    JobId job;        // the client's number
    view::View view;  // id and revision are the master's to choose
    std::uint64_t spp = 64;
    Duration time_limit{0};  // 0 = spp decides
    Policy policy = Policy::Mixed;
    bool reproducible = false;
    std::uint32_t tile = 0;  // edge in pixels; 0 = the nodes' preference
    std::uint32_t wait_nodes = 1;
    Duration wait_limit{std::chrono::seconds(60)};
    PictureEncoding picture = PictureEncoding::None;
    bool film = true;    // deliver the statistics, too
    Duration budget{0};  // not 0: the picture is ready so long after the start, filter and encoding included
    bool adapts_size =
        false;  // with a budget: a half or a quarter of the size, where it is too small for 2 samples
    static constexpr auto describe(auto row) {
        return std::tuple(
            row(1, "job", &StartJob::job), row(2, "view", &StartJob::view), row(3, "spp", &StartJob::spp),
            row(4, "time_limit", &StartJob::time_limit), row(5, "policy", &StartJob::policy),
            row(6, "reproducible", &StartJob::reproducible), row(7, "tile", &StartJob::tile),
            row(8, "wait_nodes", &StartJob::wait_nodes), row(9, "wait_limit", &StartJob::wait_limit),
            row(10, "picture", &StartJob::picture, UpTo{PictureEncoding::Exr}),
            row(11, "film", &StartJob::film), row(12, "budget", &StartJob::budget),
            row(13, "adapts_size", &StartJob::adapts_size));
    }
};
struct StopJob {
    JobId job;  // deliver what is merged so far
    static constexpr auto describe(auto row) { return std::tuple(row(1, "job", &StopJob::job)); }
};
enum class JobPhase : std::uint8_t { WaitingForNodes, Syncing, Rendering, Delivering, Filtering };
constexpr auto enumerators(JobPhase) {
    return std::to_array<std::string_view>(
        {"waiting_for_nodes", "syncing", "rendering", "delivering", "filtering"});
}
struct JobProgress {
    JobId job;
    JobPhase phase = JobPhase::WaitingForNodes;
    std::uint64_t samples = 0, samples_expected = 0;  // pixel samples
    std::uint64_t rays = 0;
    std::uint32_t nodes = 0;
    Duration elapsed{};
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "job", &JobProgress::job), row(2, "phase", &JobProgress::phase),
                          row(3, "samples", &JobProgress::samples),
                          row(4, "samples_expected", &JobProgress::samples_expected),
                          row(5, "rays", &JobProgress::rays), row(6, "nodes", &JobProgress::nodes),
                          row(7, "elapsed", &JobProgress::elapsed));
    }
};
enum class JobOutcome : std::uint8_t { Complete, TimeUp, Stopped, NoNodes, Failed };
constexpr auto enumerators(JobOutcome) {
    return std::to_array<std::string_view>({"complete", "time_up", "stopped", "no_nodes", "failed"});
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
// The picture that PictureChunks bring.
struct PictureSummary {
    PictureEncoding encoding = PictureEncoding::None;
    std::uint32_t width = 0, height = 0, components = 0;
    std::uint64_t byte_size = 0;
    std::string filter;       // as it ran: name and values
    std::uint32_t scale = 1;  // 2, 4: rendered at this part of the size and upsampled
    double seconds_filter = 0, seconds_encode = 0;
    double seconds_predicted = 0;  // with a budget: what was set aside for filter and encoding
    std::vector<FilterPass> passes;
    std::vector<std::string> notes;  // for a person
    static constexpr auto describe(auto row) {
        using Self = PictureSummary;
        return std::tuple(row(1, "encoding", &Self::encoding, UpTo{PictureEncoding::Exr}),
                          row(2, "width", &Self::width), row(3, "height", &Self::height),
                          row(4, "components", &Self::components), row(5, "byte_size", &Self::byte_size),
                          row(6, "filter", &Self::filter), row(7, "scale", &Self::scale),
                          row(8, "seconds_filter", &Self::seconds_filter),
                          row(9, "seconds_encode", &Self::seconds_encode),
                          row(10, "seconds_predicted", &Self::seconds_predicted),
                          row(11, "passes", &Self::passes), row(12, "notes", &Self::notes));
    }
};
struct JobDone {
    JobId job;
    JobOutcome outcome = JobOutcome::Complete;
    std::string message;
    std::uint32_t tiles = 0;  // that many FrameTiles come on the bulk link
    Version version;
    std::uint64_t seed = 0;
    double seconds_render = 0, first_picture_seconds = 0;
    std::uint64_t rays = 0, samples = 0, nonfinite_samples = 0;
    std::uint64_t triangles = 0, instances = 0, lights = 0;
    std::vector<NodeSummary> nodes;
    UnitCounts units;
    WireBytes wire_bytes;
    PictureSummary picture;
    std::uint64_t samples_least = 0, samples_most = 0;  // of a pixel
    static constexpr auto describe(auto row) {
        return std::tuple(
            row(1, "job", &JobDone::job), row(2, "outcome", &JobDone::outcome),
            row(3, "message", &JobDone::message), row(4, "tiles", &JobDone::tiles),
            row(5, "version", &JobDone::version), row(6, "seed", &JobDone::seed),
            row(7, "seconds_render", &JobDone::seconds_render),
            row(8, "first_picture_seconds", &JobDone::first_picture_seconds), row(9, "rays", &JobDone::rays),
            row(10, "samples", &JobDone::samples), row(11, "nonfinite_samples", &JobDone::nonfinite_samples),
            row(12, "triangles", &JobDone::triangles), row(13, "instances", &JobDone::instances),
            row(14, "lights", &JobDone::lights), row(15, "nodes", &JobDone::nodes),
            row(16, "units", &JobDone::units), row(17, "wire_bytes", &JobDone::wire_bytes),
            row(18, "picture", &JobDone::picture), row(19, "samples_least", &JobDone::samples_least),
            row(20, "samples_most", &JobDone::samples_most));
    }
};

// Another filter for the frame that is being rendered. Answered by FilterSet.
struct SetFilter {
    std::string filter;  // as View::filter
    static constexpr auto describe(auto row) { return std::tuple(row(1, "filter", &SetFilter::filter)); }
};
struct FilterSet {
    bool accepted = false;
    std::string text;  // what it means for the frame, or why not
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "accepted", &FilterSet::accepted), row(2, "text", &FilterSet::text));
    }
};

struct StatusRequest {
    static constexpr auto describe(auto) { return std::tuple(); }
};
struct NodeStatus {
    NodeSummary summary;
    NodePhase phase = NodePhase::Idle;
    Version version;
    std::uint32_t units_in_hand = 0;
    double samples_per_second = 0, round_trip_seconds = 0;
    bool stuck = false;
    double clock_offset_seconds = 0, clock_bound_seconds = 0;  // its clock less the master's, +- bound
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "summary", &NodeStatus::summary), row(2, "phase", &NodeStatus::phase),
                          row(3, "version", &NodeStatus::version),
                          row(4, "units_in_hand", &NodeStatus::units_in_hand),
                          row(5, "samples_per_second", &NodeStatus::samples_per_second),
                          row(6, "round_trip_seconds", &NodeStatus::round_trip_seconds),
                          row(7, "stuck", &NodeStatus::stuck),
                          row(8, "clock_offset_seconds", &NodeStatus::clock_offset_seconds),
                          row(9, "clock_bound_seconds", &NodeStatus::clock_bound_seconds));
    }
};
struct StatusReply {
    std::string software;
    Version version;
    double uptime_seconds = 0;
    std::uint64_t blobs = 0, blob_bytes = 0;
    std::uint32_t sessions = 0, queued = 0;
    std::uint64_t dropped_messages = 0;  // malformed, from revoked keys, or not allowed for the role
    UnitCounts units;
    WireBytes wire_bytes;
    std::vector<NodeStatus> nodes;
    LiveStatus live;
    std::uint64_t resyncs = 0;  // nodes that had to be sent the whole scene again
    DisplayStatus display;
    static constexpr auto describe(auto row) {
        return std::tuple(
            row(1, "software", &StatusReply::software), row(2, "version", &StatusReply::version),
            row(3, "uptime_seconds", &StatusReply::uptime_seconds), row(4, "blobs", &StatusReply::blobs),
            row(5, "blob_bytes", &StatusReply::blob_bytes), row(6, "sessions", &StatusReply::sessions),
            row(7, "queued", &StatusReply::queued),
            row(8, "dropped_messages", &StatusReply::dropped_messages), row(9, "units", &StatusReply::units),
            row(10, "wire_bytes", &StatusReply::wire_bytes), row(11, "nodes", &StatusReply::nodes),
            row(12, "live", &StatusReply::live), row(13, "resyncs", &StatusReply::resyncs),
            row(14, "display", &StatusReply::display));
    }
};

}  // namespace tessera::wire
