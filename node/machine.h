#pragma once

#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "mediator/backend/backend.h"
#include "mediator/net/liveness.h"
#include "mediator/wire/blob_transfer.h"
#include "mediator/wire/messages.h"
#include "node/scene_replica.h"
#include "node/settings.h"
#include "node/work_queue.h"

namespace tessera::node {

// What the loop has to do for the machine. Order matters.
struct SendControl {
    wire::ControlMessage message;
};
struct SendBulk {
    wire::BulkMessage message;
};
struct SendFilm {  // then tell film_sent()
    UnitId unit;
    std::vector<wire::FilmPart> parts;
};
struct HoldBulk {};  // the master does not know who is at its end
struct OpenBulk {    // ends the hold; before anything else
    std::uint64_t token = 0;
};
struct DropFilm {};   // what waits to be sent belongs to nobody any more
struct Reconnect {};  // new sockets; what was said on the old ones is void
struct Render {       // then tell finished()
    view::View view;
    view::WorkUnit unit;
};
struct StopUnit {
    UnitId unit;
};
struct BuildScene {  // then tell built()
    SceneReplica::Build build;
};
struct LoadBlobs {  // from the cache, if they are there; then tell looked_up()
    std::vector<scene::BlobRef> blobs;
};
struct SaveBlob {
    scene::BlobPtr blob;
};
struct Report {
    wire::Severity severity = wire::Severity::Info;
    std::string text;
};
using Action = std::variant<SendControl, SendBulk, SendFilm, HoldBulk, OpenBulk, DropFilm, Reconnect, Render,
                            StopUnit, BuildScene, LoadBlobs, SaveBlob, Report>;

// How a unit ended on its worker.
struct UnitOutcome {
    backend::RenderResult result;
    std::string error;  // not empty: the back-end gave up, and how to replay it
    Duration busy{};
};

// How a build ended.
struct BuildOutcome {
    Expected<backend::EditReport> report = backend::EditReport{};
    std::vector<std::string> problems;  // of what the network brought
};

// The node's decisions, without sockets, threads or clocks: (what happened, now) -> actions.
//
//   state    | Welcome          | scene built | Work    | last film sent | Leave, stop | Unknown, silence |
//   Refusal
//   ---------+------------------+-------------+---------+----------------+-------------+------------------+--------
//   Joining  | Syncing or Idle  |             |         |                | Left        | Joining again    |
//   Left Syncing  | as from Joining  | Idle        | release |                | Leaving     | Joining | Left
//   Idle     | as from Joining  | Idle        | Working |                | Leaving     | Joining          |
//   Left Working  | as from Joining  | Working     | Working | Idle           | Leaving     | Joining | Left
//   Leaving  |                  |             | release | Left           | Left at 2nd | Left             |
//   Left
//
// Who is welcomed under the number it had goes on where it was; another number drops units and film, another
// epoch the scene too. Units being rendered go on while the link is down.
class NodeMachine {
  public:
    enum class State { Joining, Syncing, Idle, Working, Leaving, Left };

    NodeMachine(const NodeSettings& settings, const backend::Capabilities& capabilities,
                std::shared_ptr<scene::BlobStore> blobs, TimePoint now);

    void control(wire::ControlMessage&& message, TimePoint now);
    void bulk(wire::BulkMessage&& message, TimePoint now);
    void malformed(const std::string& reason, TimePoint now);
    void finished(UnitId unit, UnitOutcome&& outcome, TimePoint now);
    void film_sent(UnitId unit);
    void built(BuildOutcome&& outcome, TimePoint now);
    void looked_up(const std::vector<scene::BlobRef>& blobs, TimePoint now);
    void leave(const std::string& reason, TimePoint now);  // the second time: at once
    void tick(TimePoint now);  // after whatever else happened, and at next_event()

    std::vector<Action> take_actions() { return std::exchange(actions_, {}); }
    TimePoint next_event(TimePoint now) const;
    State state() const;
    const NodeCounters& counters() const { return counters_; }
    const std::string& failure_text() const { return failure_text_; }  // not empty: left because of it
    const SceneReplica& replica() const { return replica_; }

  private:
    void send(wire::ControlMessage message) { actions_.emplace_back(SendControl{std::move(message)}); }
    void report(wire::Severity severity, std::string text) {
        actions_.emplace_back(Report{severity, std::move(text)});
    }
    void say_hello(TimePoint now);
    void lose_link(TimePoint now, const std::string& why);
    void leave_now(const std::string& reason);
    void fail(const std::string& reason);
    void heartbeat(TimePoint now);
    void keep_link(TimePoint now);
    wire::NodePhase phase() const;

    void on(wire::Welcome& welcome, TimePoint now);
    void on(wire::Refusal& refusal, TimePoint now);
    void on(wire::Unknown& unknown, TimePoint now);
    void on(wire::Heartbeat& beat, TimePoint now);
    void on(wire::Leave& leave, TimePoint now);
    void on(wire::Goodbye& goodbye, TimePoint now);
    void on(wire::Changes& changes, TimePoint now);
    void on(wire::ChangesByBlob& changes, TimePoint now);
    void on(wire::OpenView& open, TimePoint now);
    void on(wire::CloseView& close, TimePoint now);
    void on(wire::Work& work, TimePoint now);
    void on(wire::CancelUnits& cancel, TimePoint now);
    template <class Other>
    void on(Other&, TimePoint now) {
        malformed("a message that no master sends to a node", now);
    }

    // machine_scene.cpp
    void judged(SceneReplica::Verdict verdict, Version from, Version to, TimePoint now);
    std::int64_t received_at(Version to);  // and forgets what led there
    void scene_failed(const std::string& reason, Version at, TimePoint now);
    void scene_too_large(const std::string& reason, Version at);
    void ask_for_snapshot(const std::string& reason, TimePoint now);
    void send_version_report();
    void step_scene(TimePoint now);
    void want(const std::vector<scene::BlobRef>& blobs);
    void keep_fetching(TimePoint now);

    // machine_work.cpp
    std::optional<std::pair<wire::ReleaseReason, std::string>> objection(const view::WorkUnit& unit) const;
    void release(UnitId unit, wire::ReleaseReason reason, std::string message);
    void release_waiting(wire::ReleaseReason reason, const std::string& message, ViewId of_view = {});
    void stop(UnitId unit, wire::ReleaseReason reason);
    void send_film(const view::WorkUnit& unit, UnitOutcome&& outcome);
    void abandon_units();
    void dispatch();

    NodeSettings settings_;
    backend::Capabilities capabilities_;
    std::shared_ptr<scene::BlobStore> blobs_;
    SceneReplica replica_;
    WorkQueue queue_;
    wire::BlobFetcher fetcher_;
    net::Liveness liveness_;
    std::vector<Action> actions_;
    NodeCounters counters_;

    bool welcomed_ = false, leaving_ = false, left_ = false, changed_ = false;
    std::string leave_reason_, failure_text_;
    std::uint64_t number_ = 0, token_ = 0, epoch_ = 0;
    Duration heartbeat_interval_;
    std::optional<TimePoint> reconnect_at_;
    std::int64_t master_sent_at_ = 0;  // of its latest heartbeat, to echo
    TimePoint master_heard_at_{};
    TimePoint hello_at_{};

    std::set<Hash256> wanted_, looked_up_;
    std::optional<TimePoint> snapshot_retry_at_, absent_retry_at_;
    Version failed_at_;                 // where the scene went wrong last
    std::optional<Version> too_large_;  // the device has no room for it
    std::deque<std::pair<Version, TimePoint>>
        lists_received_;  // where those lead that are not built, and when
    wire::VersionReport latest_report_;

    std::map<ViewId, view::View> views_;
    std::map<UnitId, wire::ReleaseReason> stopping_;           // being rendered, told to stop, and why
    std::map<UnitId, wire::UnitReleased> release_after_film_;  // its parts are on their way
    std::set<UnitId> abandoned_;                               // being rendered for nobody
    std::deque<UnitId> units_sent_;                            // the latest, for the goodbye
};

const char* name(NodeMachine::State state);

}  // namespace tessera::node
