#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mediator/net/liveness.h"
#include "node/scene_sync.h"
#include "node/unit_tracker.h"

namespace tessera::node {

// The node's state machine, without sockets, threads or clocks: (event, now) -> actions.
//
//   state    | Welcome          | scene built | Work    | last film sent | Leave, stop | Unknown, silence | Refusal
//   ---------+------------------+-------------+---------+----------------+-------------+------------------+--------
//   Joining  | Syncing or Idle  |             |         |                | Left        | Joining again    | Left
//   Syncing  | as from Joining  | Idle        | release |                | Leaving     | Joining          | Left
//   Idle     | as from Joining  | Idle        | Working |                | Leaving     | Joining          | Left
//   Working  | as from Joining  | Working     | Working | Idle           | Leaving     | Joining          | Left
//   Leaving  |                  |             | release | Left           | Left at 2nd | Left             | Left
//
// A node welcomed under its old number resumes; another number discards units and film, another epoch also the scene.
// Units being rendered continue while the link is down.
class NodeStateMachine {
  public:
    enum class State { Joining, Syncing, Idle, Working, Leaving, Left };

    NodeStateMachine(const NodeSettings& settings, const backend::Capabilities& capabilities,
                     std::shared_ptr<scene::BlobStore> blobs, TimePoint now);

    NodeStateMachine(const NodeStateMachine&) = delete;  // its parts refer to each other
    NodeStateMachine& operator=(const NodeStateMachine&) = delete;

    void control(wire::ControlMessage&& message, TimePoint now);
    void bulk(wire::BulkMessage&& message, TimePoint now);
    void malformed(const std::string& reason, TimePoint now);
    void finished(UnitId unit, UnitOutcome&& outcome, TimePoint now);
    void film_sent(UnitId unit);
    void film_withdrawn(UnitId unit);
    void built(BuildOutcome&& outcome, TimePoint now);
    void looked_up(const std::vector<scene::BlobRef>& blobs, TimePoint now);
    void leave(const std::string& reason, Drain drain, TimePoint now);  // a second call leaves immediately
    void tick(TimePoint now);  // after every other call, and at next_event()

    std::vector<Action> take_actions() { return std::exchange(effects_.actions, {}); }
    TimePoint next_event(TimePoint now) const;
    State state() const;
    const NodeCounters& counters() const { return effects_.counters; }
    const std::string& failure_text() const { return failure_text_; }  // not empty: the reason it left
    const SceneReplica& replica() const { return scene_.replica(); }

  private:
    void send_hello(TimePoint now);
    void on_disconnect(TimePoint now, const std::string& why);
    void leave_now(const std::string& reason);
    void fail(const std::string& reason);
    void heartbeat(TimePoint now);
    void maintain_link(TimePoint now);
    void step_scene(TimePoint now);
    void dispatch();
    session::NodePhase phase() const;

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
    void on(wire::FilmTaken& taken, TimePoint now);
    template <class Other>
    void on(Other&, TimePoint now) {
        malformed("unexpected message from the master", now);
    }

    NodeSettings settings_;
    backend::Capabilities capabilities_;
    std::uint32_t workers_;
    Effects effects_;
    SceneSync scene_;
    UnitTracker units_;
    net::Liveness liveness_;

    bool welcomed_ = false, leaving_ = false, left_ = false;
    std::optional<TimePoint> leave_by_;  // leaves then, whatever is still being sent
    std::string leave_reason_, failure_text_;
    std::uint64_t number_ = 0, token_ = 0, epoch_ = 0;
    Duration heartbeat_interval_;
    std::optional<TimePoint> reconnect_at_;
    std::int64_t master_sent_at_ = 0;  // of its latest heartbeat, to echo
    TimePoint master_heard_at_{};
    TimePoint hello_at_{};
};

const char* name(NodeStateMachine::State state);

}  // namespace tessera::node
