#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "mediator/base/clock.h"
#include "mediator/base/hash.h"
#include "mediator/base/ids.h"
#include "mediator/frame/film_tile.h"
#include "mediator/frame/render_revision.h"
#include "mediator/scene/change_list.h"
#include "mediator/view/view.h"
#include "mediator/view/work_unit.h"
#include "mediator/wire/display_messages.h"
#include "mediator/wire/live_messages.h"

// What goes over the control link, as plain values; `envelope.h` turns them into bytes and back. A message
// arrives complete and checked, or as an Error, never half. Numbers of the protocol live in proto/,
// structures live here.
namespace tessera::wire {

inline constexpr std::uint32_t ProtocolVersion = 1;

enum class PeerKind : std::uint8_t { Client, Node };

// First on the control link. The master answers Welcome or Refusal.
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
    std::uint32_t render_revision = frame::RenderRevision;  // of its film; 0: of before there were any
    // of a peer that reconnects: what it held in the same epoch, so that it is taken for the same
    std::uint64_t resume_token = 0;
};

struct Welcome {
    std::uint64_t peer_number = 0;  // a NodeId or SessionId
    std::uint64_t token = 0;        // secret; first on the bulk link, and to resume
    std::uint64_t epoch = 0;
    Duration heartbeat_interval{};
    std::uint32_t missed_heartbeats = 3;
};

struct Refusal {
    std::string reason;  // a sentence for a person
};

// "I do not know you": say hello again.
struct Unknown {};

enum class NodePhase : std::uint8_t { Idle, Syncing, Building, Rendering, Leaving };

// Both ways, every interval and whenever the state changes. Credits are absolute, so a lost one does no harm.
struct Heartbeat {
    std::int64_t sent_at = 0;       // ns, sender's clock
    std::int64_t echo_sent_at = 0;  // the other's latest sent_at, and how long it lay here
    std::int64_t echo_delay = 0;
    // of nodes
    NodePhase phase = NodePhase::Idle;
    std::uint64_t progress = 0;  // samples finished since the start; grows while work goes on
    Version version;             // committed with all blobs
    std::vector<UnitId> in_hand;
    std::uint32_t free_places = 0;
    std::uint64_t last_work_sequence = 0;  // of the latest Work seen; younger ones are still on their way
};

// ---- scene, master to node ----

struct Changes {
    scene::ChangeList list;  // at most 64 KiB encoded; longer ones go as a blob
};
struct ChangesByBlob {
    Version from, to;
    scene::BlobRef blob;  // an encoded ChangeList
};
// Node to master: committed with all blobs. Wrong hash = resync.
struct VersionReport {
    Version version;
    Hash128 state_hash;
    std::uint64_t triangles = 0, instances = 0, lights = 0, degenerate_triangles = 0;
    std::uint32_t entries = 0, relevant = 0, rebuilt = 0, refitted = 0, retransformed = 0;
    std::vector<std::string> ignored_kinds, problems;
    std::int64_t received_at = 0, built_at = 0;  // ns, the node's clock: the list came, was committed
};
// Node to master: a gap, another epoch or a wrong hash; asks for a snapshot.
struct Resync {
    Version version;  // what it holds
    std::string reason;
};
// Node to master: its device has no room for this version; it keeps the last one that fitted, and tries the
// next.
struct SceneRefused {
    Version version;
    std::string reason;
};

// ---- work ----

struct OpenView {
    view::View view;  // again with a new revision: replaces
};
struct CloseView {
    ViewId view;
};
struct Work {
    std::uint64_t sequence = 0;  // per node, +1 each
    view::WorkUnit unit;
};
struct CancelUnits {
    std::vector<UnitId> units;
};
enum class ReleaseReason : std::uint8_t { Cancelled, OtherVersion, UnknownView, Leaving, Failed };
// Node to master: no (more) film will come of this unit.
struct UnitReleased {
    UnitId unit;
    ReleaseReason reason = ReleaseReason::Cancelled;
    std::string message;
};
// Master to node: drain and say goodbye.
struct Leave {};
// A peer goes. `units_sent`: units whose film it has sent; everything else it held is handed back.
struct Goodbye {
    std::string reason;
    std::vector<UnitId> units_sent;
};
enum class Severity : std::uint8_t { Info, Warning, Error };
struct Notice {
    Severity severity = Severity::Info;
    std::string text;
};

// ---- sessions, client and master ----

// Asks for the stage: one batch scene at a time. Answered by QueuePlace until SceneOpened (or Refusal with
// no_wait).
struct OpenScene {
    std::string title;
    bool no_wait = false;
};
struct QueuePlace {
    std::uint32_t place = 0;  // 1 = next
};
struct SceneOpened {
    Version version;
    std::uint64_t first_id = 0, id_count = 0;  // lent to this session for new objects
};
struct SubmitEdit {
    scene::Edit edit;
};
struct SubmitEditByBlob {
    SessionId session;
    std::uint64_t sequence = 0;
    Version base;
    scene::BlobRef blob;  // an encoded Edit
};
struct EditReply {
    std::uint64_t sequence = 0;
    bool accepted = false;
    Version version;                    // that holds it, or will when it is published
    std::vector<std::string> problems;  // why not
    std::uint64_t transaction = 0;      // that it is, or is part of
    std::vector<std::string> notes;     // of an undo: what was left as later edits made it
};

enum class Policy : std::uint8_t { Tiled, Cooperative, Mixed };
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
};
struct StopJob {
    JobId job;  // deliver what is merged so far
};
enum class JobPhase : std::uint8_t { WaitingForNodes, Syncing, Rendering, Delivering, Filtering };
struct JobProgress {
    JobId job;
    JobPhase phase = JobPhase::WaitingForNodes;
    std::uint64_t samples = 0, samples_expected = 0;  // pixel samples
    std::uint64_t rays = 0;
    std::uint32_t nodes = 0;
    Duration elapsed{};
};
enum class JobOutcome : std::uint8_t { Complete, TimeUp, Stopped, NoNodes, Failed };
struct NodeSummary {
    NodeId id;
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
};

// Another filter for the frame that is being rendered. Answered by FilterSet.
struct SetFilter {
    std::string filter;  // as View::filter
};
struct FilterSet {
    bool accepted = false;
    std::string text;  // what it means for the frame, or why not
};

struct StatusRequest {};
struct NodeStatus {
    NodeSummary summary;
    NodePhase phase = NodePhase::Idle;
    Version version;
    std::uint32_t units_in_hand = 0;
    double samples_per_second = 0, round_trip_seconds = 0;
    bool stuck = false;
    double clock_offset_seconds = 0, clock_bound_seconds = 0;  // its clock less the master's, +- bound
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
};

// The order is the order of the cases in proto/control.proto; codecs rely on it.
using ControlMessage =
    std::variant<Hello, Welcome, Refusal, Unknown, Heartbeat, Changes, ChangesByBlob, VersionReport, Resync,
                 OpenView, CloseView, Work, CancelUnits, UnitReleased, Leave, Goodbye, Notice, OpenScene,
                 QueuePlace, SceneOpened, SubmitEdit, SubmitEditByBlob, EditReply, StartJob, StopJob,
                 JobProgress, JobDone, StatusRequest, StatusReply, SetFilter, FilterSet, SceneRefused,
                 JoinScene, SceneJoined, RequestDone, CloseScene, ReadScene, SceneContent, LockObjects,
                 SetPresence, ReadPeople, People, ReadHistory, History, ReadWriters, Writers, OpenLiveView,
                 CloseLiveView, FrameTaken, Pick, Picked, ReadTrace, Trace, OpenDisplay, CloseDisplay,
                 AdjustDisplay, MoveHead, JoinOutput, OutputOpened, OutputReady, PresentFrame>;

// ---- bulk link: fixed little-endian header, then raw planes ----

struct BulkHello {
    std::uint64_t token = 0;
};
struct BlobRequest {
    Hash256 hash;
    std::uint64_t offset = 0;
};
struct BlobChunk {
    Hash256 hash;
    std::uint64_t total = 0, offset = 0;
    std::vector<std::byte> data;  // at most 1 MiB
};
struct BlobAbsent {
    Hash256 hash;
};
// Node to master: blocks of a unit; a unit that was stopped sends several, `part` of `parts`.
struct FilmPart {
    UnitId unit;
    ViewId view;
    std::uint64_t revision = 0;
    Version version;
    std::uint16_t part = 0, parts = 1;
    std::uint64_t rays = 0;     // of the whole unit, in part 0
    std::uint64_t busy_ns = 0;  // likewise
    frame::FilmTile film;
};
// Master to client: the merged film of one tile.
struct FrameTile {
    JobId job;
    std::uint32_t index = 0, count = 0;
    frame::FilmTile film;  // block means nothing here: the counts say all
};
// Master to client: a piece of the picture, as JobDone describes it.
struct PictureChunk {
    JobId job;
    std::uint64_t total = 0, offset = 0;
    std::vector<std::byte> data;  // at most 1 MiB
};
// Master to client: a frame of a view that it opened, in front of its PictureChunks and FrameTiles, whose job
// is the frame's number. One is on its way at a time: the next comes after FrameTaken.
struct LiveFrame {
    std::uint64_t view = 0, frame = 0;  // the client's number of the view; frames count from 1
    Version version;                    // of the scene that is seen
    std::uint64_t revision = 0;         // of the view: grows with every change of its camera
    std::uint32_t scale = 1;            // 8, 4, 2: a coarse picture of this part of the view's size
    std::uint32_t width = 0, height = 0, components = 0;
    PictureEncoding encoding = PictureEncoding::None;
    std::uint64_t picture_bytes = 0;
    std::uint32_t film_tiles = 0;
    std::uint64_t samples_least = 0, samples_most = 0, spp = 0;  // of a pixel, and how many there will be
    bool complete = false;
    Hash256 film_hash;  // when complete
};
// Master to output process: a piece of an eye's picture of a frame; pieces of one picture come in order.
struct OutputPicture {
    std::uint64_t frame = 0;
    view::Eye eye = view::Eye::Mono;
    std::uint32_t eyes = 1;   // pictures of this frame for this output
    Version version;          // of the scene that is seen
    view::CameraPose camera;  // in display space, that it was rendered with
    std::uint32_t width = 0, height = 0;
    PictureEncoding encoding = PictureEncoding::Bytes;  // or Half
    std::uint64_t samples = 0;                          // of a pixel, the least
    std::uint64_t total = 0, offset = 0;                // bytes of the picture
    std::vector<std::byte> data;                        // at most 1 MiB
};
using BulkMessage = std::variant<BulkHello, BlobRequest, BlobChunk, BlobAbsent, FilmPart, FrameTile,
                                 PictureChunk, LiveFrame, OutputPicture>;

}  // namespace tessera::wire
