#include "tests/master/render/simulated_cluster.h"

#include <algorithm>

namespace tessera::master {

namespace {

double samples_in(const view::WorkUnit& unit) {
    return static_cast<double>(unit.block.count() * unit.tile.pixel_count());
}

}  // namespace

SimulatedCluster::SimulatedCluster(std::vector<Node> nodes, const PlanSettings& plan)
    : scheduler_(plan, ViewId{1}, 1, Version{1, 1}, UnitId{1}, std::nullopt),
      coverage_(scheduler_.tiles().size()) {
    for (Node& node : nodes)
        nodes_.push_back({.node = std::move(node), .waiting = {}, .running = {}, .held = {}});
}

std::uint32_t SimulatedCluster::tile_of(const view::WorkUnit& unit) const {
    const auto& tiles = scheduler_.tiles();
    return static_cast<std::uint32_t>(std::find(tiles.begin(), tiles.end(), unit.tile) - tiles.begin());
}

bool SimulatedCluster::is_covered(std::uint64_t spp) const {
    return std::all_of(coverage_.begin(), coverage_.end(),
                       [&](const BlockSet& tile) { return tile.sample_count() == spp; });
}

double SimulatedCluster::rate(const State& state) const {
    return now_ >= state.node.slow_from ? state.node.rate * state.node.slow_factor : state.node.rate;
}

double SimulatedCluster::run() {
    for (std::uint64_t step = 0; !scheduler_.complete() && step < 10'000'000; ++step) {
        deal();
        double next = events_.empty() ? 1e9 : events_.begin()->first;
        std::size_t who = nodes_.size(), which = 0;
        bool dies = false;
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            const State& state = nodes_[i];
            if (!state.is_alive) continue;
            if (state.node.dies_at < next) {
                next = state.node.dies_at;
                who = i;
                dies = true;
            }
            for (std::size_t k = 0; k < state.running.size(); ++k) {
                if (state.running[k].done_at >= next) continue;
                next = state.running[k].done_at;
                who = i;
                which = k;
                dies = false;
            }
        }
        if (next >= 1e9) break;
        now_ = std::max(now_, next);
        if (who == nodes_.size()) {
            const Event event = events_.begin()->second;
            events_.erase(events_.begin());
            handle(event);
        } else if (dies) {
            kill(who);
        } else {
            finish(who, which);
        }
    }
    return now_;
}

void SimulatedCluster::deal() {
    std::vector<NodeCapacity> capacities;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        const State& state = nodes_[i];
        if (!state.is_alive) continue;
        const std::uint32_t slots = 2 * state.node.workers;
        capacities.push_back({.node = NodeId{i + 1},
                              .workers = state.node.workers,
                              .free_slots = slots - std::min(slots, state.known_in_flight),
                              .in_flight = state.known_in_flight});
    }
    for (const Assignment& assignment : scheduler_.assign(capacities, balancer_, at(now_))) {
        const std::size_t i = assignment.node.value - 1;
        ++nodes_[i].known_in_flight;
        later(nodes_[i].node.latency, {Kind::WorkArrives, i, assignment.unit});
    }
}

void SimulatedCluster::start_workers(State& state) {
    while (!state.waiting.empty() && state.running.size() < state.node.workers) {
        const view::WorkUnit unit = state.waiting.front();
        state.waiting.pop_front();
        state.running.push_back({unit, now_ + samples_in(unit) / rate(state)});
    }
}

void SimulatedCluster::finish(std::size_t who, std::size_t running) {
    State& state = nodes_[who];
    const view::WorkUnit unit = state.running[running].unit;
    state.running.erase(state.running.begin() + static_cast<std::ptrdiff_t>(running));
    start_workers(state);
    if (state.node.fails_on.contains(tile_of(unit)))
        return later(state.node.latency, {Kind::FailureArrives, who, unit});
    const auto samples = static_cast<std::uint64_t>(samples_in(unit));
    state.samples += samples;
    rendered_ += samples;
    balancer_.measured(NodeId{who + 1}, samples,
                       Duration(static_cast<std::int64_t>(samples_in(unit) / rate(state) * 1e9)));
    later(state.node.latency, {Kind::SlotIsFree, who, unit});
    hold(who, {tile_of(unit), unit.block}, false);
}

// Merges the film with its siblings, and sends what has no other half in hand.
void SimulatedCluster::hold(std::size_t who, Film film, bool flush) {
    State& state = nodes_[who];
    for (auto half = state.held.begin(); half != state.held.end();) {
        if (half->tile != film.tile || half->block != film.block.sibling()) {
            ++half;
            continue;
        }
        film.block = film.block.parent();
        state.held.erase(half);
        half = state.held.begin();
    }
    state.held.push_back(film);
    std::erase_if(state.held, [&](const Film& item) {
        const auto is_coming = [&](const view::WorkUnit& unit) {
            return tile_of(unit) == item.tile && item.block.sibling().contains(unit.block);
        };
        const bool waits = std::any_of(state.waiting.begin(), state.waiting.end(), is_coming) ||
                           std::any_of(state.running.begin(), state.running.end(),
                                       [&](const Running& unit) { return is_coming(unit.unit); });
        if (waits && !flush) return false;
        later(state.node.latency, {.kind = Kind::FilmArrives, .node = who, .unit = {}, .film = item});
        return true;
    });
}

void SimulatedCluster::handle(const Event& event) {
    State& state = nodes_[event.node];
    const NodeId id{event.node + 1};
    switch (event.kind) {
        case Kind::WorkArrives:
            state.waiting.push_back(event.unit);
            return start_workers(state);
        case Kind::SlotIsFree:
            --state.known_in_flight;
            return;
        case Kind::FailureArrives:
            --state.known_in_flight;
            scheduler_.failed(event.unit.id, id, UnitTrouble::Kind::Failed, "it fails");
            return;
        case Kind::CancelArrives: {
            const std::size_t before = state.waiting.size();
            std::erase_if(state.waiting, [&](const auto& unit) { return unit.id == event.unit.id; });
            if (state.waiting.size() == before) return;  // it is being rendered: its film is a duplicate
            later(state.node.latency, {Kind::SlotIsFree, event.node, event.unit});
            scheduler_.end(event.unit.id, id, Fate::Cancelled);
            return;
        }
        case Kind::FilmArrives:
            if (!state.is_alive) return;
            ++films_;
            coverage_[event.film.tile].insert(event.film.block);
            for (const Cancellation& cancelled : scheduler_.merged(id, event.film.tile, event.film.block)) {
                view::WorkUnit unit;
                unit.id = cancelled.unit;
                const std::size_t other = cancelled.node.value - 1;
                later(nodes_[other].node.latency, {Kind::CancelArrives, other, unit});
            }
            return;
    }
}

void SimulatedCluster::kill(std::size_t who) {
    State& state = nodes_[who];
    state.is_alive = false;
    state.waiting.clear();
    state.running.clear();
    state.held.clear();
    balancer_.forget(NodeId{who + 1});
    scheduler_.node_gone({.node = NodeId{who + 1}, .describe = {}});
    std::erase_if(events_, [&](const auto& entry) { return entry.second.node == who; });
}

}  // namespace tessera::master
