#include "tests/master/render/simulated_cluster.h"

#include <algorithm>

#include "master/render/schedule/stuck_allowance.h"

namespace tessera::master {

namespace {

constexpr double Never = SimulatedNodeSettings::Never;
constexpr double Turn = 0.001;  // the master's loop handles what arrives within that time at once
constexpr double HeartbeatTime = 1.0, TickTime = 0.25;
constexpr double LongestFrame = 1e6;
constexpr std::uint32_t SlotsPerWorker = 2;  // see NodeRecord::capacity()

}  // namespace

SimulatedCluster::SimulatedCluster(const std::vector<Node>& nodes, const PlanSettings& plan)
    : tile_edge_(plan.tile),
      columns_((static_cast<std::uint32_t>(plan.window.width) + plan.tile - 1) / plan.tile),
      work_(static_cast<double>(plan.window.pixel_count() * plan.spp)),
      hold_film_(seconds(plan.hold_film)),
      scheduler_(plan, ViewId{1}, 1, Version{1, 1}, UnitId{1}, std::nullopt),
      table_({}, {}),
      accepted_(scheduler_.tiles().size()) {
    for (const Node& node : nodes) members_.push_back({.node = {node, hold_film_}, .id = {}});
    for (Member& member : members_) {
        join(member);
        const Node& settings = member.node.settings();
        const double phase =
            static_cast<double>(&member - members_.data()) / static_cast<double>(nodes.size());
        schedule(phase * HeartbeatTime, Kind::HeartbeatDue, &member);
        if (settings.dies_at < Never && !settings.dies_silently)
            schedule(settings.dies_at + settings.latency, Kind::ConnectionEnds, &member);
    }
    schedule(TickTime, Kind::Tick);
}

double SimulatedCluster::ideal_time() const {
    double from = 0.0, to = LongestFrame;
    while (to - from > 1e-6 * to) {
        const double middle = 0.5 * (from + to);
        double rendered = 0.0;
        for (const Member& member : members_)
            rendered += member.node.settings().workers * member.node.rate().rendered(0.0, middle);
        (rendered < work_ ? from : to) = middle;
    }
    return to;
}

bool SimulatedCluster::is_covered(std::uint64_t spp) const {
    return std::ranges::all_of(accepted_, [&](const auto& blocks) {
        std::uint64_t next = 0;
        for (const auto& [first, level] : blocks) {
            if (first != next) return false;
            next = first + (std::uint64_t{1} << level);
        }
        return next == spp;
    });
}

double SimulatedCluster::duplicated_samples() const {
    auto samples = static_cast<double>(covered_twice_);
    for (const Member& member : members_) samples += member.node.wasted_samples();
    return samples;
}

double SimulatedCluster::run() {
    next_turn();
    while (!scheduler_.complete() && !events_.empty() && now_ < LongestFrame) {
        const Event event = events_.top();
        events_.pop();
        now_ = event.at;
        handle(event);
    }
    return now_;
}

// ---- events ----

void SimulatedCluster::schedule(double at, Kind kind, const Member* member, UnitId unit,
                                const Message& message) {
    if (at >= Never) return;
    events_.push({.at = at,
                  .order = order_++,
                  .kind = kind,
                  .member = member == nullptr ? 0 : index(*member),
                  .life = member == nullptr ? 0 : member->life,
                  .unit = unit,
                  .message = message});
}

// A node that stands still reads its messages when it goes on.
void SimulatedCluster::send(Member& member, Kind kind, UnitId unit) {
    schedule(awake(member, now_ + member.node.settings().latency), kind, &member, unit);
}

double SimulatedCluster::awake(const Member& member, double time) {
    const Node& node = member.node.settings();
    return node.is_deaf(time) ? node.stalls_at + node.stalls_for : time;
}

void SimulatedCluster::handle(const Event& event) {
    if (event.kind == Kind::Turn) {
        has_turn_ = false;
        return deal();
    }
    if (event.kind == Kind::Tick) return tick();
    Member& member = members_[event.member];
    if (event.kind == Kind::ConnectionEnds) {
        if (member.is_known) lose(member, true);
        ++member.life;
        return next_turn();
    }
    if (event.life != member.life) return;
    switch (event.kind) {
        case Kind::Message:
            message(member, event.message);
            return next_turn();
        case Kind::Heartbeat:
            heartbeat(member, event);
            return next_turn();
        case Kind::Join:
            if (now_ >= member.node.settings().dies_at) return;
            ++member.life;
            scheduler_.came_back(member.id);
            member.node.forget_everything(now_);
            join(member);
            schedule(now_ + HeartbeatTime, Kind::HeartbeatDue, &member);
            return next_turn();
        default:
            if (now_ >= member.node.settings().dies_at) return;
            handle_at_node(event);
            return after(member);
    }
}

void SimulatedCluster::handle_at_node(const Event& event) {
    Member& member = members_[event.member];
    switch (event.kind) {
        case Kind::Work:
            return member.node.work(unit(event.unit), now_);
        case Kind::Cancel:
            return member.node.cancel(unit(event.unit), now_);
        case Kind::Finish:
            return member.node.finish(event.unit, now_);
        case Kind::HoldLimit:
            return member.node.send_ready(now_);
        default:
            return beat(member);
    }
}

// Sends what the node has to say.
void SimulatedCluster::after(Member& member) {
    for (const SimulatedNode::Start& start : member.node.take_starts())
        schedule(start.done_at, Kind::Finish, &member, start.unit);
    for (const Message& message : member.node.take_messages())
        schedule(now_ + member.node.settings().latency, Kind::Message, &member, message.unit, message);
    const std::optional<double> oldest = member.node.oldest_film();
    if (!oldest || member.hold_limit > now_) return;
    member.hold_limit = awake(member, std::max(now_, *oldest + hold_film_)) + 1e-6;
    schedule(member.hold_limit, Kind::HoldLimit, &member);
}

void SimulatedCluster::beat(Member& member) {
    events_.push({.at = now_ + member.node.settings().latency,
                  .order = order_++,
                  .kind = Kind::Heartbeat,
                  .member = index(member),
                  .life = member.life,
                  .progress = member.node.samples(),
                  .works = !member.node.is_idle()});
    schedule(awake(member, now_ + HeartbeatTime), Kind::HeartbeatDue, &member);
}

// ---- the master ----

void SimulatedCluster::next_turn() {
    if (!std::exchange(has_turn_, true)) schedule(now_ + Turn, Kind::Turn);
}

void SimulatedCluster::join(Member& member) {
    member.id = NodeId{next_id_++};
    member.occupied = member.in_flight = 0;
    member.hold_limit = 0.0;
    member.is_known = true;
    member.is_stuck = member.has_sent_film = member.rejoins = false;
    by_id_[member.id] = index(member);
    table_.add(member.id, member.id.value, member.id.value, "", {}, time_point(now_));
}

// It is asked to say hello again.
void SimulatedCluster::unknown(Member& member) {
    if (!std::exchange(member.rejoins, true))
        schedule(awake(member, now_ + 3.0 * member.node.settings().latency), Kind::Join, &member);
}

void SimulatedCluster::message(Member& member, const Message& message) {
    if (!member.is_known) {
        if (message.kind == Message::Kind::Film) covered_twice_ += message.film.samples;
        return unknown(member);
    }
    table_.find(member.id)->liveness.on_message(time_point(now_));
    switch (message.kind) {
        case Message::Kind::SlotIsFree:
            --member.occupied;
            return;
        case Message::Kind::Film:
            return film(member, message.film);
        case Message::Kind::Released:
            --member.in_flight;
            scheduler_.end(message.unit, member.id, Fate::Cancelled);
            return;
        case Message::Kind::Failed:
            --member.in_flight;
            scheduler_.failed(message.unit, member.id, UnitTrouble::Kind::Failed, "it fails");
            return;
    }
}

void SimulatedCluster::film(Member& member, const SimulatedNode::Film& film) {
    ++films_;
    member.in_flight -= film.units;
    const Rect& tile = scheduler_.tiles()[film.tile];
    const Admission admission = scheduler_.admit(member.id, {film.unit, Version{1, 1}, tile, film.block});
    if (!admission.problem.empty()) {
        ++refused_;
        return;
    }
    const std::optional<std::uint64_t> known = accept(film.tile, film.block, admission.replaceable);
    covered_twice_ += known.value_or(film.block.count()) * tile.pixel_count();
    member.has_sent_film = true;
    if (!known) return scheduler_.end_film(member.id, film.tile, film.block, Fate::Duplicate);
    balancer_.measured(member.id, film.samples, time_point(film.busy) - TimePoint{});
    for (const Cancellation& cancelled : scheduler_.merged(member.id, film.tile, film.block)) {
        const auto holder = by_id_.find(cancelled.node);
        if (holder != by_id_.end()) send(members_[holder->second], Kind::Cancel, cancelled.unit);
    }
}

// As frame::BlockForest does with film: how many of the samples were there. Nothing: it has film of others, and is dropped.
std::optional<std::uint64_t> SimulatedCluster::accept(std::uint32_t tile, const frame::SampleBlock& block,
                                                      const BlockSet& replaceable) {
    auto& blocks = accepted_[tile];
    const auto after = blocks.upper_bound(block.first);
    if (after != blocks.begin()) {
        const auto& [first, level] = *std::prev(after);
        if (frame::SampleBlock{first, level}.contains(block)) return block.count();
    }
    const auto begin = blocks.lower_bound(block.first), end = blocks.lower_bound(block.end());
    std::uint64_t known = 0;
    for (auto inside = begin; inside != end; ++inside) {
        const frame::SampleBlock there{inside->first, inside->second};
        if (!replaceable.covers(there)) return std::nullopt;
        known += there.count();
    }
    blocks.erase(begin, end);
    frame::SampleBlock joined = block;
    for (auto other = blocks.find(joined.sibling().first);
         other != blocks.end() && other->second == joined.level;
         other = blocks.find(joined.sibling().first)) {
        blocks.erase(other);
        joined = joined.parent();
    }
    blocks.emplace(joined.first, joined.level);
    return known;
}

Duration SimulatedCluster::allowance(const Member& member) const {
    const StuckSettings& settings = table_.stuck();
    if (!member.has_sent_film) return settings.first_film;
    std::uint64_t largest = 0;
    for (const UnitId id : scheduler_.held_by(member.id))
        largest = std::max(largest, units_[id.value - 1].samples);
    return stuck_allowance(settings, balancer_.rate(member.id), largest);
}

void SimulatedCluster::heartbeat(Member& member, const Event& event) {
    if (!member.is_known) return unknown(member);
    NodeRecord& record = *table_.find(member.id);
    record.liveness.on_message(time_point(now_));
    record.allowance = allowance(member);
    const auto phase = event.works ? session::NodePhase::Rendering : session::NodePhase::Idle;
    table_.heartbeat(record, {.phase = phase, .progress = event.progress, .in_flight = {}}, time_point(now_));
    member.is_stuck = record.stuck;
}

void SimulatedCluster::lose(Member& member, bool has_ended) {
    balancer_.forget(member.id);
    scheduler_.node_gone({.node = member.id,
                          .rendering = member.node.settings().workers,
                          .has_ended = has_ended,
                          .now = time_point(now_),
                          .describe = {}});
    table_.remove(member.id);
    by_id_.erase(member.id);
    member.is_known = false;
}

void SimulatedCluster::tick() {
    for (const NodeId id : table_.timed_out(time_point(now_))) lose(members_[by_id_.at(id)], false);
    for (const auto& [id, record] : table_.all()) {
        if (!record.stuck) continue;
        const std::uint32_t workers = members_[by_id_.at(id)].node.settings().workers;
        scheduler_.node_gone({.node = id, .rendering = workers, .now = time_point(now_), .describe = {}});
    }
    next_turn();
    const bool goes_on = std::ranges::any_of(members_, [&](const Member& member) {
        return member.is_known || member.node.settings().dies_at > now_;
    });
    if (goes_on) schedule(now_ + TickTime, Kind::Tick);
}

void SimulatedCluster::deal() {
    capacities_.clear();
    for (const Member& member : members_) {
        if (!member.is_known || member.is_stuck) continue;
        const std::uint32_t workers = member.node.settings().workers, slots = SlotsPerWorker * workers;
        capacities_.push_back({.node = member.id,
                               .workers = workers,
                               .free_slots = slots - std::min(slots, member.occupied),
                               .in_flight = member.in_flight,
                               .round_trip_seconds = 2.0 * member.node.settings().latency,
                               .heartbeat_at = table_.find(member.id)->heartbeat_at});
    }
    for (const Assignment& assignment : scheduler_.assign(capacities_, balancer_, time_point(now_))) {
        Member& member = members_[by_id_.at(assignment.node)];
        const view::WorkUnit& work = assignment.unit;
        if (work.id.value > units_.size()) {
            const std::uint32_t column = static_cast<std::uint32_t>(work.tile.x) / tile_edge_;
            const std::uint32_t row = static_cast<std::uint32_t>(work.tile.y) / tile_edge_;
            units_.push_back({.id = work.id,
                              .tile = row * columns_ + column,
                              .block = work.block,
                              .samples = work.block.count() * work.tile.pixel_count()});
        }
        ++member.occupied;
        ++member.in_flight;
        send(member, Kind::Work, work.id);
    }
}

}  // namespace tessera::master
