#include "node/node_state_machine.h"

#include <algorithm>

namespace tessera::node {

namespace {

constexpr Duration Forever = std::chrono::hours(1);

}  // namespace

NodeStateMachine::NodeStateMachine(const NodeSettings& settings, const backend::Capabilities& capabilities,
                                   std::shared_ptr<scene::BlobStore> blobs, TimePoint now)
    : settings_(settings),
      capabilities_(capabilities),
      workers_(std::max(1u, settings.workers ? settings.workers : capabilities.concurrent_units)),
      scene_(settings, std::move(blobs), effects_),
      units_(workers_, capabilities, scene_.replica(), effects_),
      liveness_(settings.liveness, now),
      heartbeat_interval_(settings.liveness.interval) {
    send_hello(now);
}

void NodeStateMachine::send_hello(TimePoint now) {
    hello_at_ = now;
    effects_.send(wire::Hello{.peer = wire::PeerKind::Node,
                              .name = settings_.name,
                              .host = settings_.host,
                              .software = settings_.software,
                              .pid = settings_.pid,
                              .backend = settings_.backend,
                              .kind = capabilities_.kind,
                              .channels = capabilities_.channels,
                              .renderers = capabilities_.renderers,
                              .preferred_tile = capabilities_.preferred_tile,
                              .concurrent_units = workers_,
                              .reproducible = settings_.reproducible,
                              .resume_token = token_});
}

void NodeStateMachine::control(wire::ControlMessage&& message, TimePoint now) {
    if (left_) return;
    liveness_.on_message(now);
    std::visit([&](auto& content) { on(content, now); }, message);
}

void NodeStateMachine::malformed(const std::string& reason, TimePoint now) {
    liveness_.on_message(now);
    effects_.malformed(reason);
}

void NodeStateMachine::on(wire::Welcome& welcome, TimePoint now) {
    const bool same_epoch = welcome.epoch == epoch_;
    if (same_epoch && welcome.peer_number < number_) return;  // an outdated reply: numbers only grow
    const bool same_identity = same_epoch && welcome.peer_number == number_;
    if (!same_identity) units_.abandon();
    units_.welcomed(welcome.epoch);
    welcomed_ = true;
    number_ = welcome.peer_number;
    token_ = welcome.token;
    epoch_ = welcome.epoch;
    net::LivenessSettings liveness = settings_.liveness;
    liveness.interval = std::clamp<Duration>(welcome.heartbeat_interval, std::chrono::milliseconds(1),
                                             std::chrono::minutes(1));
    liveness.missed = static_cast<int>(std::clamp<std::uint32_t>(welcome.missed_heartbeats, 1, 100));
    heartbeat_interval_ = liveness.interval;
    scene_.welcomed(epoch_, heartbeat_interval_);
    liveness_ = net::Liveness(liveness, now);
    liveness_.on_message(now);
    reconnect_at_.reset();
    master_sent_at_ = 0;
    effects_.add(OpenBulk{token_});
    heartbeat(now);
    effects_.report(wire::Severity::Info, same_identity
                                              ? "back with the master as node " + std::to_string(number_)
                                              : "joined the master as node " + std::to_string(number_));
    step_scene(now);
}

void NodeStateMachine::on(wire::Refusal& refusal, TimePoint) {
    fail("the master refused this node: " + refusal.reason);
}

void NodeStateMachine::on(wire::Unknown&, TimePoint now) {
    const bool answered_already = !welcomed_ && now - hello_at_ < heartbeat_interval_;
    if (answered_already) return;  // a reply to a message sent before the Hello
    welcomed_ = false;
    scene_.link_lost();
    effects_.add(PauseBulk{});
    send_hello(now);
}

void NodeStateMachine::on(wire::Heartbeat& beat, TimePoint now) {
    master_sent_at_ = beat.sent_at;
    master_heard_at_ = now;
}

void NodeStateMachine::on(wire::Leave&, TimePoint now) {
    if (!leaving_) leave("the master requested it", Drain::Finish, now);
}

void NodeStateMachine::on(wire::Goodbye& goodbye, TimePoint now) {
    on_disconnect(now, "the master left: " + goodbye.reason);
}

void NodeStateMachine::on(wire::Changes& changes, TimePoint now) {
    scene_.changes(changes, now);
    step_scene(now);
}

void NodeStateMachine::on(wire::ChangesByBlob& changes, TimePoint now) {
    scene_.changes(changes, now);
    step_scene(now);
}

void NodeStateMachine::on(wire::OpenView& open, TimePoint) {
    units_.open(open);
}

void NodeStateMachine::on(wire::CloseView& close, TimePoint) {
    units_.close(close);
}

void NodeStateMachine::on(wire::Work& work, TimePoint) {
    if (!welcomed_) return;
    units_.work(work, leaving_);
    dispatch();
}

void NodeStateMachine::on(wire::CancelUnits& cancel, TimePoint) {
    units_.cancel(cancel);
}

void NodeStateMachine::on(wire::FilmTaken& taken, TimePoint) {
    effects_.add(FilmTaken{taken.bytes});
}

void NodeStateMachine::bulk(wire::BulkMessage&& message, TimePoint now) {
    if (left_) return;
    liveness_.on_message(now);
    if (auto* chunk = std::get_if<wire::BlobChunk>(&message)) {
        if (scene_.chunk(std::move(*chunk), now)) step_scene(now);
    } else if (const auto* absent = std::get_if<wire::BlobAbsent>(&message)) {
        scene_.absent(*absent, now);
    } else {
        malformed("unexpected bulk message from the master", now);
    }
}

void NodeStateMachine::looked_up(const std::vector<scene::BlobRef>& blobs, TimePoint now) {
    scene_.looked_up(blobs);
    step_scene(now);
}

void NodeStateMachine::step_scene(TimePoint now) {
    if (left_ || leaving_) return;
    if (scene_.advance(now)) units_.version_ends();
}

void NodeStateMachine::built(BuildOutcome&& outcome, TimePoint now) {
    if (left_) return;
    if (scene_.built(std::move(outcome), now)) units_.recheck_waiting();
    step_scene(now);
}

void NodeStateMachine::finished(UnitId unit, UnitOutcome&& outcome, TimePoint now) {
    if (left_) return;
    units_.finished(unit, std::move(outcome), now);
    dispatch();
}

void NodeStateMachine::film_sent(UnitId unit) {
    units_.film_sent(unit);
}

void NodeStateMachine::film_withdrawn(UnitId unit) {
    units_.film_withdrawn(unit);
}

void NodeStateMachine::dispatch() {
    if (!leaving_ && !left_) units_.dispatch();
}

void NodeStateMachine::on_disconnect(TimePoint now, const std::string& why) {
    if (leaving_) {
        left_ = true;
        return;
    }
    welcomed_ = false;
    scene_.link_lost();
    effects_.add(PauseBulk{});
    const Duration backoff = liveness_.next_backoff();
    reconnect_at_ = now + backoff;
    effects_.report(wire::Severity::Warning, why + "; trying again");
}

session::NodePhase NodeStateMachine::phase() const {
    if (leaving_) return session::NodePhase::Leaving;
    const SceneReplica& replica = scene_.replica();
    if (replica.is_building()) return session::NodePhase::Building;
    if (replica.is_behind() || replica.version().number == 0) return session::NodePhase::Syncing;
    return units_.empty() ? session::NodePhase::Idle : session::NodePhase::Rendering;
}

void NodeStateMachine::heartbeat(TimePoint now) {
    effects_.state_changed = false;
    liveness_.sent_heartbeat(now);
    effects_.send(wire::Heartbeat{.sent_at = now.time_since_epoch().count(),
                                  .echo_sent_at = master_sent_at_,
                                  .echo_delay = master_sent_at_ ? (now - master_heard_at_).count() : 0,
                                  .phase = phase(),
                                  .progress = effects_.counters.samples,
                                  .version = scene_.replica().version(),
                                  .in_flight = units_.in_flight(),
                                  .free_slots = leaving_ ? 0 : units_.free_slots(),
                                  .last_work_sequence = units_.last_sequence(),
                                  .scene_bytes = scene_.received_bytes()});
}

void NodeStateMachine::maintain_link(TimePoint now) {
    if (reconnect_at_) {
        if (now < *reconnect_at_) return;
        reconnect_at_.reset();
        ++effects_.counters.reconnects;
        effects_.add(Reconnect{});
        liveness_.restarted(now);
        send_hello(now);
    } else if (liveness_.timed_out(now)) {
        on_disconnect(now, "the master is silent");
    } else if (welcomed_) {
        const bool due = liveness_.heartbeat_due(now);
        // Repeating the token is harmless and replaces a lost one.
        if (due) effects_.add(SendBulk{wire::BulkHello{token_}});
        if (due || effects_.state_changed) heartbeat(now);
    }
}

void NodeStateMachine::tick(TimePoint now) {
    if (left_) return;
    if (!leaving_) {
        step_scene(now);
        if (left_) return;
        scene_.keep_fetching(now);
    }
    units_.send_ready(now);
    dispatch();
    maintain_link(now);
    if (leaving_ && (units_.empty() || (leave_by_ && now >= *leave_by_))) leave_now(leave_reason_);
}

void NodeStateMachine::leave(const std::string& reason, Drain drain, TimePoint now) {
    if (left_) return;
    leave_reason_ = reason;
    if (leaving_ || !welcomed_) return leave_now(reason);
    leaving_ = true;
    const bool finishes = drain == Drain::Finish;
    effects_.report(wire::Severity::Info, "leaving: " + reason +
                                              (finishes ? "; finishing what is being rendered"
                                                        : "; handing back what is being rendered"));
    units_.release_waiting(wire::ReleaseReason::Leaving, "the node leaves");
    if (!finishes) {
        units_.hand_back();
        leave_by_ = now + LeaveLimit;
    }
    heartbeat(now);
}

void NodeStateMachine::leave_now(const std::string& reason) {
    units_.stop_all();
    if (token_ != 0) {
        effects_.send(wire::Goodbye{.reason = reason, .units_sent = units_.latest_sent()});
    }
    leaving_ = left_ = true;
}

void NodeStateMachine::fail(const std::string& reason) {
    failure_text_ = reason;
    effects_.report(wire::Severity::Error, reason);
    leave_now(reason);
}

TimePoint NodeStateMachine::next_event(TimePoint now) const {
    // Heartbeats begin with the welcome.
    TimePoint next = reconnect_at_ ? *reconnect_at_
                     : welcomed_   ? liveness_.next_event()
                                   : liveness_.times_out_at();
    if (const auto due = scene_.next_event(now)) next = std::min(next, *due);
    if (leave_by_) next = std::min(next, *leave_by_);
    if (const auto due = units_.next_event()) next = std::min(next, std::max(now, *due));
    return std::clamp(next, now, now + Forever);
}

NodeStateMachine::State NodeStateMachine::state() const {
    if (left_) return State::Left;
    if (leaving_) return State::Leaving;
    if (!welcomed_) return State::Joining;
    if (scene_.replica().version().number == 0) return State::Syncing;
    return units_.empty() ? State::Idle : State::Working;
}

const char* name(NodeStateMachine::State state) {
    switch (state) {
        case NodeStateMachine::State::Joining:
            return "joining";
        case NodeStateMachine::State::Syncing:
            return "syncing";
        case NodeStateMachine::State::Idle:
            return "idle";
        case NodeStateMachine::State::Working:
            return "working";
        case NodeStateMachine::State::Leaving:
            return "leaving";
        case NodeStateMachine::State::Left:
            return "left";
    }
    return "";
}

}  // namespace tessera::node
