// Joining, keeping the link, leaving.
#include "node/machine.h"

#include <algorithm>

namespace tessera::node {

namespace {

constexpr Duration Forever = std::chrono::hours(1);

}  // namespace

NodeMachine::NodeMachine(const NodeSettings& settings, const backend::Capabilities& capabilities,
                         std::shared_ptr<scene::BlobStore> blobs, TimePoint now)
    : settings_(settings),
      capabilities_(capabilities),
      blobs_(blobs),
      replica_(blobs),
      queue_(std::max(1u, settings.workers ? settings.workers : capabilities.concurrent_units)),
      fetcher_(blobs, settings.blob_limits),
      liveness_(settings.liveness, now),
      heartbeat_interval_(settings.liveness.interval) {
    say_hello(now);
}

void NodeMachine::say_hello(TimePoint now) {
    hello_at_ = now;
    send(wire::Hello{.peer = wire::PeerKind::Node,
                     .name = settings_.name,
                     .host = settings_.host,
                     .software = settings_.software,
                     .pid = settings_.pid,
                     .backend = settings_.backend,
                     .kind = capabilities_.kind,
                     .channels = capabilities_.channels,
                     .renderers = capabilities_.renderers,
                     .preferred_tile = capabilities_.preferred_tile,
                     .concurrent_units =
                         std::max(1u, settings_.workers ? settings_.workers : capabilities_.concurrent_units),
                     .reproducible = settings_.reproducible,
                     .resume_token = token_});
}

void NodeMachine::control(wire::ControlMessage&& message, TimePoint now) {
    if (left_) return;
    liveness_.heard(now);
    std::visit([&](auto& content) { on(content, now); }, message);
}

void NodeMachine::malformed(const std::string& reason, TimePoint now) {
    liveness_.heard(now);
    ++counters_.malformed_messages;
    report(wire::Severity::Warning, "dropped a message of the master: " + reason);
}

void NodeMachine::on(wire::Welcome& welcome, TimePoint now) {
    const bool same_epoch = welcome.epoch == epoch_;
    if (same_epoch && welcome.peer_number < number_) return;  // an old answer: numbers only grow
    const bool same_identity = same_epoch && welcome.peer_number == number_;
    if (!same_identity) {
        abandon_units();
        views_.clear();
    }
    if (!same_epoch) {
        fetcher_.forget_all();
        wanted_.clear();
        failed_at_ = {};
    }
    replica_.start_epoch(welcome.epoch);
    queue_.restart_sequence();
    welcomed_ = true;
    number_ = welcome.peer_number;
    token_ = welcome.token;
    epoch_ = welcome.epoch;
    net::LivenessSettings liveness = settings_.liveness;
    liveness.interval = std::clamp<Duration>(welcome.heartbeat_interval, std::chrono::milliseconds(1),
                                             std::chrono::minutes(1));
    liveness.missed = static_cast<int>(std::clamp<std::uint32_t>(welcome.missed_heartbeats, 1, 100));
    heartbeat_interval_ = liveness.interval;
    liveness_ = net::Liveness(liveness, now);
    liveness_.heard(now);
    reconnect_at_.reset();
    master_sent_at_ = 0;
    actions_.emplace_back(OpenBulk{token_});
    heartbeat(now);
    report(wire::Severity::Info, same_identity ? "back with the master as node " + std::to_string(number_)
                                               : "joined the master as node " + std::to_string(number_));
    step_scene(now);
}

void NodeMachine::on(wire::Refusal& refusal, TimePoint) {
    fail("the master refused this node: " + refusal.reason);
}

void NodeMachine::on(wire::Unknown&, TimePoint now) {
    const bool answered_already = !welcomed_ && now - hello_at_ < heartbeat_interval_;
    if (answered_already) return;  // to what was sent before the hello
    welcomed_ = false;
    actions_.emplace_back(HoldBulk{});
    say_hello(now);
}

void NodeMachine::on(wire::Heartbeat& beat, TimePoint now) {
    master_sent_at_ = beat.sent_at;
    master_heard_at_ = now;
}

void NodeMachine::on(wire::Leave&, TimePoint now) {
    if (!leaving_) leave("the master asked for it", now);
}

void NodeMachine::on(wire::Goodbye& goodbye, TimePoint now) {
    lose_link(now, "the master left: " + goodbye.reason);
}

void NodeMachine::lose_link(TimePoint now, const std::string& why) {
    if (leaving_) {
        left_ = true;
        return;
    }
    welcomed_ = false;
    actions_.emplace_back(HoldBulk{});
    const Duration backoff = liveness_.next_backoff();
    reconnect_at_ = now + backoff;
    report(wire::Severity::Warning, why + "; trying again");
}

wire::NodePhase NodeMachine::phase() const {
    if (leaving_) return wire::NodePhase::Leaving;
    if (replica_.is_building()) return wire::NodePhase::Building;
    if (replica_.is_behind() || replica_.version().number == 0) return wire::NodePhase::Syncing;
    return queue_.empty() ? wire::NodePhase::Idle : wire::NodePhase::Rendering;
}

void NodeMachine::heartbeat(TimePoint now) {
    changed_ = false;
    liveness_.sent_heartbeat(now);
    std::vector<UnitId> in_hand = queue_.in_hand();
    std::erase_if(in_hand, [&](UnitId unit) { return abandoned_.contains(unit); });
    send(wire::Heartbeat{.sent_at = now.time_since_epoch().count(),
                         .echo_sent_at = master_sent_at_,
                         .echo_delay = master_sent_at_ ? (now - master_heard_at_).count() : 0,
                         .phase = phase(),
                         .progress = counters_.samples,
                         .version = replica_.version(),
                         .in_hand = std::move(in_hand),
                         .free_places = leaving_ ? 0 : queue_.free_places(),
                         .last_work_sequence = queue_.last_sequence()});
}

void NodeMachine::keep_link(TimePoint now) {
    if (reconnect_at_) {
        if (now < *reconnect_at_) return;
        reconnect_at_.reset();
        ++counters_.reconnects;
        actions_.emplace_back(Reconnect{});
        liveness_.restarted(now);
        say_hello(now);
    } else if (liveness_.dead(now)) {
        lose_link(now, "the master is silent");
    } else if (welcomed_) {
        const bool due = liveness_.heartbeat_due(now);
        // A repeated token costs nothing and mends a lost one.
        if (due) actions_.emplace_back(SendBulk{wire::BulkHello{token_}});
        if (due || changed_) heartbeat(now);
    }
}

void NodeMachine::tick(TimePoint now) {
    if (left_) return;
    if (!leaving_) {
        step_scene(now);
        if (left_) return;
        keep_fetching(now);
    }
    dispatch();
    keep_link(now);
    if (leaving_ && queue_.empty()) leave_now(leave_reason_);
}

void NodeMachine::leave(const std::string& reason, TimePoint now) {
    if (left_) return;
    leave_reason_ = reason;
    if (leaving_ || !welcomed_) return leave_now(reason);
    leaving_ = true;
    report(wire::Severity::Info, "leaving: " + reason + "; finishing what is being rendered");
    release_waiting(wire::ReleaseReason::Leaving, "the node leaves");
    heartbeat(now);
}

void NodeMachine::leave_now(const std::string& reason) {
    for (const view::WorkUnit& unit : queue_.rendering()) actions_.emplace_back(StopUnit{unit.id});
    if (token_ != 0) {
        send(wire::Goodbye{.reason = reason, .units_sent = {units_sent_.begin(), units_sent_.end()}});
    }
    leaving_ = left_ = true;
}

void NodeMachine::fail(const std::string& reason) {
    failure_text_ = reason;
    report(wire::Severity::Error, reason);
    leave_now(reason);
}

TimePoint NodeMachine::next_event(TimePoint now) const {
    TimePoint next = reconnect_at_ ? *reconnect_at_ : liveness_.next_event();
    if (snapshot_retry_at_) next = std::min(next, *snapshot_retry_at_);
    if (absent_retry_at_) next = std::min(next, *absent_retry_at_);
    if (!fetcher_.idle()) next = std::min(next, now + std::chrono::milliseconds(100));
    return std::clamp(next, now, now + Forever);
}

NodeMachine::State NodeMachine::state() const {
    if (left_) return State::Left;
    if (leaving_) return State::Leaving;
    if (!welcomed_) return State::Joining;
    if (replica_.version().number == 0) return State::Syncing;
    return queue_.empty() ? State::Idle : State::Working;
}

const char* name(NodeMachine::State state) {
    switch (state) {
        case NodeMachine::State::Joining:
            return "joining";
        case NodeMachine::State::Syncing:
            return "syncing";
        case NodeMachine::State::Idle:
            return "idle";
        case NodeMachine::State::Working:
            return "working";
        case NodeMachine::State::Leaving:
            return "leaving";
        case NodeMachine::State::Left:
            return "left";
    }
    return "";
}

}  // namespace tessera::node
