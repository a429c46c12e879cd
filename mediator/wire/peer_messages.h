#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "mediator/base/clock.h"
#include "mediator/base/description.h"
#include "mediator/base/hash.h"
#include "mediator/base/ids.h"
#include "mediator/frame/render_revision.h"
#include "mediator/scene/change_list.h"
#include "mediator/session/node_phase.h"
#include "mediator/view/view.h"
#include "mediator/view/work_unit.h"

// Handshake and heartbeats of all peers, and messages between the master and its nodes.
namespace tessera::wire {

inline constexpr std::uint32_t ProtocolVersion = 6;

// Names appear in status and summaries of many peers, which have to fit messages.
inline constexpr std::size_t MaxNameBytes = 256;
inline constexpr std::uint32_t MaxConcurrentUnits = 4096;

enum class PeerKind : std::uint8_t { Client, Node };
constexpr auto enumerators(PeerKind) {
    return std::to_array<std::string_view>({"client", "node"});
}

// The first message on the control link. The master answers with Welcome or Refusal.
struct Hello {
    std::uint32_t protocol = ProtocolVersion;
    PeerKind peer = PeerKind::Client;
    std::string name, host, software;
    std::uint64_t pid = 0;
    // of nodes
    std::string backend, kind;
    frame::ChannelSet channels;
    view::RendererSet renderers = view::TracingRenderers;
    std::uint32_t preferred_tile = 32;
    std::uint32_t concurrent_units = 1;
    bool reproducible = false;                              // pinned to AVX2 (design 1.6)
    std::uint32_t render_revision = frame::RenderRevision;  // of its film; 0: older than render revisions
    // of a reconnecting peer: its token of the same epoch, which identifies it
    std::uint64_t resume_token = 0;
    static constexpr auto describe(auto row) {
        constexpr auto channels = [](std::size_t word) {
            return [word](auto& hello) -> auto& {
                return hello.channels.words()[word];
            };
        };
        return std::tuple(
            row(1, "protocol", &Hello::protocol), row(2, "peer", &Hello::peer), row(3, "name", &Hello::name),
            row(4, "host", &Hello::host), row(5, "software", &Hello::software), row(6, "pid", &Hello::pid),
            row(7, "backend", &Hello::backend), row(8, "kind", &Hello::kind), row(9, "channels", channels(0)),
            row(10, "preferred_tile", &Hello::preferred_tile),
            row(11, "concurrent_units", &Hello::concurrent_units),
            row(12, "reproducible", &Hello::reproducible),
            row(13, "resume_token", &Hello::resume_token, FullWidth{}),
            row(14, "renderers", &Hello::renderers), row(15, "render_revision", &Hello::render_revision),
            row(16, "later_channels", channels(1)));
    }
    const char* malformed() const {
        if (!channels.is_known()) return "a channel is unknown";
        for (const std::string* text : {&name, &host, &software, &backend, &kind}) {
            if (text->size() > MaxNameBytes) return "a name is longer than 256 bytes";
        }
        if (concurrent_units > MaxConcurrentUnits) return "a node renders at most 4096 units at a time";
        return nullptr;
    }
};

struct Welcome {
    std::uint64_t peer_number = 0;  // a NodeId or SessionId
    std::uint64_t token = 0;        // secret; authenticates the bulk link and reconnections
    std::uint64_t epoch = 0;
    Duration heartbeat_interval{};
    std::uint32_t missed_heartbeats = 3;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "peer_number", &Welcome::peer_number),
                          row(2, "token", &Welcome::token, FullWidth{}), row(3, "epoch", &Welcome::epoch),
                          row(4, "heartbeat_interval", &Welcome::heartbeat_interval),
                          row(5, "missed_heartbeats", &Welcome::missed_heartbeats));
    }
};

struct Refusal {
    std::string reason;  // readable reason
    static constexpr auto describe(auto row) { return std::tuple(row(1, "reason", &Refusal::reason)); }
};

// The master does not know the sender: it has to send Hello again.
struct Unknown {
    static constexpr auto describe(auto) { return std::tuple(); }
};

// In both directions, every interval and whenever the state changes. Credits are absolute, so a lost one does no harm.
struct Heartbeat {
    std::int64_t sent_at = 0;       // ns, sender's clock
    std::int64_t echo_sent_at = 0;  // the other's latest sent_at, and the time since its arrival
    std::int64_t echo_delay = 0;
    // of nodes
    session::NodePhase phase = session::NodePhase::Idle;
    std::uint64_t progress = 0;  // samples finished since the start; grows while rendering
    Version version;             // built with all blobs
    std::vector<UnitId> in_flight;
    std::uint32_t free_slots = 0;
    std::uint64_t last_work_sequence = 0;  // of the latest Work received; later ones have not arrived yet
    std::uint64_t scene_bytes = 0;         // of blobs received since the start; grows while syncing
    static constexpr auto describe(auto row) {
        return std::tuple(
            row(1, "sent_at", &Heartbeat::sent_at), row(2, "echo_sent_at", &Heartbeat::echo_sent_at),
            row(3, "echo_delay", &Heartbeat::echo_delay), row(4, "phase", &Heartbeat::phase),
            row(5, "progress", &Heartbeat::progress), row(6, "version", &Heartbeat::version),
            row(7, "in_flight", &Heartbeat::in_flight), row(8, "free_slots", &Heartbeat::free_slots),
            row(9, "last_work_sequence", &Heartbeat::last_work_sequence),
            row(10, "scene_bytes", &Heartbeat::scene_bytes));
    }
};

// ---- scene, master to node ----

struct Changes {
    scene::ChangeList list;  // at most 64 KiB encoded; longer ones go as a blob
    static constexpr auto describe(auto row) { return std::tuple(row(1, "list", &Changes::list)); }
};
struct ChangesByBlob {
    Version from, to;
    scene::BlobRef blob;  // an encoded ChangeList
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "from", &ChangesByBlob::from), row(2, "to", &ChangesByBlob::to),
                          row(3, "blob", &ChangesByBlob::blob));
    }
};
// Node to master: a version was built with all blobs. A wrong hash leads to a resync.
struct VersionReport {
    Version version;
    Hash128 state_hash;
    std::uint64_t triangles = 0, instances = 0, lights = 0, degenerate_triangles = 0;
    std::uint32_t entries = 0, relevant = 0, rebuilt = 0, refitted = 0, retransformed = 0;
    std::vector<std::string> ignored_kinds, problems;
    std::int64_t received_at = 0, built_at = 0;  // ns, the node's clock: list received, version built
    static constexpr auto describe(auto row) {
        return std::tuple(
            row(1, "version", &VersionReport::version), row(2, "state_hash", &VersionReport::state_hash),
            row(3, "triangles", &VersionReport::triangles), row(4, "instances", &VersionReport::instances),
            row(5, "lights", &VersionReport::lights),
            row(6, "degenerate_triangles", &VersionReport::degenerate_triangles),
            row(7, "entries", &VersionReport::entries), row(8, "relevant", &VersionReport::relevant),
            row(9, "rebuilt", &VersionReport::rebuilt), row(10, "refitted", &VersionReport::refitted),
            row(11, "retransformed", &VersionReport::retransformed),
            row(12, "ignored_kinds", &VersionReport::ignored_kinds),
            row(13, "problems", &VersionReport::problems),
            row(14, "received_at", &VersionReport::received_at),
            row(15, "built_at", &VersionReport::built_at));
    }
};
// Node to master: a gap, another epoch or a wrong hash; asks for a snapshot.
struct Resync {
    Version version;  // the version it has
    std::string reason;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "version", &Resync::version), row(2, "reason", &Resync::reason));
    }
};
// Node to master: it cannot build this version, e.g. since it does not fit into its (device) memory; it keeps the last one
// that it could build and tries the next.
struct SceneRefused {
    Version version;
    std::string reason;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "version", &SceneRefused::version), row(2, "reason", &SceneRefused::reason));
    }
};

// ---- work ----

struct OpenView {
    view::View view;       // a new revision replaces the old one
    Duration hold_film{};  // film may wait so long to be merged with that of further units
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "view", &OpenView::view), row(2, "hold_film", &OpenView::hold_film));
    }
};
struct CloseView {
    ViewId view;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "view", &CloseView::view)); }
};
struct Work {
    std::uint64_t sequence = 0;  // per node, +1 each
    view::WorkUnit unit;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "sequence", &Work::sequence), row(2, "unit", &Work::unit));
    }
};
struct CancelUnits {
    std::vector<UnitId> units;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "units", &CancelUnits::units)); }
};
enum class ReleaseReason : std::uint8_t { Cancelled, OtherVersion, UnknownView, Leaving, Failed };
constexpr auto enumerators(ReleaseReason) {
    return std::to_array<std::string_view>(
        {"cancelled", "other_version", "unknown_view", "leaving", "failed"});
}
// Node to master: no (more) film of this unit will be sent.
struct UnitReleased {
    UnitId unit;
    ReleaseReason reason = ReleaseReason::Cancelled;
    std::string message;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "unit", &UnitReleased::unit), row(2, "reason", &UnitReleased::reason),
                          row(3, "message", &UnitReleased::message));
    }
};
// Master to node: bytes of film messages that have been merged or dropped since its Welcome. What a node has sent beyond
// that is in flight: it sends no more than the line carries in a moment, so that film is never outdated on arrival.
struct FilmTaken {
    std::uint64_t bytes = 0;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "bytes", &FilmTaken::bytes)); }
};
// Master to node: finish the units being rendered and disconnect.
struct Leave {
    static constexpr auto describe(auto) { return std::tuple(); }
};
// A peer disconnects. `units_sent`: units whose film was sent; all its other units are released.
struct Goodbye {
    std::string reason;
    std::vector<UnitId> units_sent;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "reason", &Goodbye::reason), row(2, "units_sent", &Goodbye::units_sent));
    }
};
enum class Severity : std::uint8_t { Info, Warning, Error };
constexpr auto enumerators(Severity) {
    return std::to_array<std::string_view>({"info", "warning", "error"});
}
struct Notice {
    Severity severity = Severity::Info;
    std::string text;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "severity", &Notice::severity), row(2, "text", &Notice::text));
    }
};

}  // namespace tessera::wire
