#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "mediator/display/display.h"
#include "mediator/session/loop_status.h"
#include "mediator/session/node_phase.h"
#include "mediator/session/view_summary.h"

// The state of a master, its nodes, its scene and its display.
namespace tessera::session {

struct StageTimes {
    std::string name;
    std::uint64_t count = 0;
    double p50_seconds = 0, p99_seconds = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "name", &StageTimes::name), row(2, "count", &StageTimes::count),
                          row(3, "p50_seconds", &StageTimes::p50_seconds),
                          row(4, "p99_seconds", &StageTimes::p99_seconds));
    }
};
struct SceneStatus {
    std::string title;       // "" = no scene is open
    bool exclusive = false;  // open for one client only
    std::uint32_t members = 0, views = 0;
    std::uint64_t edits = 0, transactions = 0, edit_bytes = 0;
    std::uint64_t versions = 0, change_bytes = 0;  // published; bytes sent to all nodes
    std::uint64_t journal_bytes = 0, checkpoints = 0;
    std::vector<StageTimes> stages;
    static constexpr auto describe(auto row) {
        using Self = SceneStatus;
        return std::tuple(row(1, "title", &Self::title), row(2, "exclusive", &Self::exclusive),
                          row(3, "members", &Self::members), row(4, "views", &Self::views),
                          row(5, "edits", &Self::edits), row(6, "transactions", &Self::transactions),
                          row(7, "edit_bytes", &Self::edit_bytes), row(8, "versions", &Self::versions),
                          row(9, "change_bytes", &Self::change_bytes),
                          row(10, "journal_bytes", &Self::journal_bytes),
                          row(11, "checkpoints", &Self::checkpoints), row(12, "stages", &Self::stages));
    }
};

struct NodeStatus {
    NodeSummary summary;
    NodePhase phase = NodePhase::Idle;
    Version version;
    std::uint32_t units_in_flight = 0;
    double samples_per_second = 0, round_trip_seconds = 0;
    bool stuck = false;
    double clock_offset_seconds = 0, clock_bound_seconds = 0;  // its clock minus the master's, +- bound
    std::string quarantine;                                    // why it gets no work; "" = it does
    double quarantine_seconds = 0;                             // until it does
    std::string idle_reason;          // why it takes no part in what is rendered; "" = it may
    std::uint64_t film_bytes = 0;     // that it has sent since it joined
    std::uint64_t scene_bytes = 0;    // changes and blobs that it has received
    double silent_seconds = 0;        // since its latest heartbeat
    std::uint32_t units_waiting = 0;  // sent to it, and not confirmed by a heartbeat yet
    std::uint32_t faults = 0;         // not forgiven yet; the next ones bring it into quarantine
    std::string last_fault;           // the latest of these
    static constexpr auto describe(auto row) {
        return std::tuple(
            row(1, "summary", &NodeStatus::summary), row(2, "phase", &NodeStatus::phase),
            row(3, "version", &NodeStatus::version), row(4, "units_in_flight", &NodeStatus::units_in_flight),
            row(5, "samples_per_second", &NodeStatus::samples_per_second),
            row(6, "round_trip_seconds", &NodeStatus::round_trip_seconds),
            row(7, "stuck", &NodeStatus::stuck),
            row(8, "clock_offset_seconds", &NodeStatus::clock_offset_seconds),
            row(9, "clock_bound_seconds", &NodeStatus::clock_bound_seconds),
            row(10, "quarantine", &NodeStatus::quarantine),
            row(11, "quarantine_seconds", &NodeStatus::quarantine_seconds),
            row(12, "idle_reason", &NodeStatus::idle_reason), row(13, "film_bytes", &NodeStatus::film_bytes),
            row(14, "scene_bytes", &NodeStatus::scene_bytes),
            row(15, "silent_seconds", &NodeStatus::silent_seconds),
            row(16, "units_waiting", &NodeStatus::units_waiting), row(17, "faults", &NodeStatus::faults),
            row(18, "last_fault", &NodeStatus::last_fault));
    }
};

enum class OutputState : std::uint8_t {
    Absent,  // no process shows it
    Joining,
    Locked,
    Late,  // was not ready in time; not waited for until it answers
};
constexpr auto enumerators(OutputState) {
    return std::to_array<std::string_view>({"absent", "joining", "locked", "late"});
}
struct OutputStatus {
    std::string name, host;
    OutputState state = OutputState::Absent;
    std::uint64_t frames = 0;  // presented
    std::uint64_t late = 0;    // times that it was dropped from the lock
    double stereo_difference =
        0.0;                    // of the latest complete frame: see picture/stereo_difference.h; 0 = unknown
    std::uint64_t samples = 0;  // per pixel, in the latest frame
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "name", &OutputStatus::name), row(2, "host", &OutputStatus::host),
                          row(3, "state", &OutputStatus::state), row(4, "frames", &OutputStatus::frames),
                          row(5, "late", &OutputStatus::late),
                          row(6, "stereo_difference", &OutputStatus::stereo_difference),
                          row(7, "samples", &OutputStatus::samples));
    }
};
struct DisplayStatus {
    std::string name;  // "" = none
    std::uint64_t frames = 0;
    Version version;  // of the latest frame
    double rate = 0;  // recent frames per second
    std::vector<OutputStatus> outputs;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "name", &DisplayStatus::name), row(2, "frames", &DisplayStatus::frames),
                          row(3, "version", &DisplayStatus::version), row(4, "rate", &DisplayStatus::rate),
                          row(5, "outputs", &DisplayStatus::outputs, Limit{display::MaxOutputs}));
    }
};

struct ClusterStatus {
    std::string software;
    Version version;
    double uptime_seconds = 0;
    std::uint64_t blobs = 0, blob_bytes = 0;
    std::uint32_t sessions = 0, queued = 0;
    std::uint64_t dropped_messages = 0;  // malformed, from revoked keys, or not allowed for the role
    UnitCounts units;
    WireBytes wire_bytes;
    std::vector<NodeStatus> nodes;
    SceneStatus scene;
    std::uint64_t resyncs = 0;  // times that a node had to be sent the whole scene again
    DisplayStatus display;
    std::uint64_t contradictions = 0;      // nodes of one kind gave different bits for the same samples
    std::uint64_t caught_exceptions = 0;   // in the master's event loop: bugs, which it survived
    std::uint64_t refused_handshakes = 0;  // connections whose key is not on the allow-list
    LoopStatus loop;
    std::uint64_t verified_units = 0;                 // rendered again by another node, with the same bits
    std::uint64_t refused_film = 0;                   // messages: malformed, or film that was not asked for
    std::uint64_t lost_nodes = 0, lost_sessions = 0;  // that fell silent, or whose connection broke
    static constexpr auto describe(auto row) {
        using Self = ClusterStatus;
        return std::tuple(
            row(1, "software", &Self::software), row(2, "version", &Self::version),
            row(3, "uptime_seconds", &Self::uptime_seconds), row(4, "blobs", &Self::blobs),
            row(5, "blob_bytes", &Self::blob_bytes), row(6, "sessions", &Self::sessions),
            row(7, "queued", &Self::queued), row(8, "dropped_messages", &Self::dropped_messages),
            row(9, "units", &Self::units), row(10, "wire_bytes", &Self::wire_bytes),
            row(11, "nodes", &Self::nodes), row(12, "scene", &Self::scene),
            row(13, "resyncs", &Self::resyncs), row(14, "display", &Self::display),
            row(15, "contradictions", &Self::contradictions),
            row(16, "caught_exceptions", &Self::caught_exceptions),
            row(17, "refused_handshakes", &Self::refused_handshakes), row(18, "loop", &Self::loop),
            row(19, "verified_units", &Self::verified_units), row(20, "refused_film", &Self::refused_film),
            row(21, "lost_nodes", &Self::lost_nodes), row(22, "lost_sessions", &Self::lost_sessions));
    }
};

}  // namespace tessera::session
