#include "master/render/schedule/scheduler.h"

#include <algorithm>

namespace tessera::master {

using frame::SampleBlock;

Scheduler::Scheduler(const PlanSettings& plan, ViewId view, std::uint64_t revision, Version version,
                     UnitId first_unit, std::optional<TimePoint> deadline)
    : plan_(plan),
      view_(view),
      revision_(revision),
      version_(version),
      next_unit_(first_unit.value),
      deadline_(deadline),
      ledger_(plan_.tiles().size()),
      tiles_without_samples_(static_cast<std::uint32_t>(plan_.tiles().size())) {}

view::WorkUnit Scheduler::make_unit(const Plan::Chunk& chunk) {
    return {.id = UnitId{next_unit_++},
            .view = view_,
            .revision = revision_,
            .version = version_,
            .tile = plan_.tiles()[chunk.tile],
            .block = chunk.block};
}

std::vector<Assignment> Scheduler::assign(std::span<const NodeCapacity> nodes, const Balancer& balancer,
                                          TimePoint now) {
    std::vector<Assignment> assignments;
    if (closed_) return assignments;
    std::uint32_t workers = 0;
    for (const NodeCapacity& node : nodes) workers += node.workers;
    std::vector<NodeCapacity> capacities(nodes.begin(), nodes.end());
    // One unit per turn, so that one node's prefetch does not empty the plan while another starves.
    for (bool dealt = true; dealt;) {
        dealt = false;
        for (NodeCapacity& node : capacities) {
            if (node.free_slots == 0) continue;
            cut_round_for_deadline(nodes, balancer, now);
            const auto splits = static_cast<std::uint32_t>(nodes.size());
            auto assignment = deal(node, balancer, workers, splits, now);
            if (!assignment && node.in_flight == 0) assignment = duplicate(node.node, balancer, now);
            if (!assignment) continue;
            --node.free_slots;
            ++node.in_flight;
            assignments.push_back(std::move(*assignment));
            dealt = true;
        }
    }
    return assignments;
}

std::optional<Assignment> Scheduler::deal(const NodeCapacity& node, const Balancer& balancer,
                                          std::uint32_t workers, std::uint32_t splits, TimePoint now) {
    const std::uint64_t samples = balancer.unit_samples(node.node, plan_.remaining_samples(), workers);
    const std::size_t pixels =
        std::max<std::size_t>(1, plan_.tiles().empty() ? 1 : plan_.tiles()[0].pixel_count());
    auto chunk = plan_.next(std::max<std::uint64_t>(1, samples / pixels), splits);
    // Film that was considered lost may have arrived after all.
    while (chunk && ledger_[chunk->tile].covers(chunk->block)) {
        chunk = plan_.next(std::max<std::uint64_t>(1, samples / pixels), splits);
    }
    if (!chunk) return std::nullopt;
    const view::WorkUnit unit = make_unit(*chunk);
    ++(chunk->again ? counts_.reissued : counts_.issued);
    outstanding_[unit.id] = {unit, chunk->tile, {{node.node, now}}};
    return Assignment{node.node, unit};
}

std::optional<Assignment> Scheduler::duplicate(NodeId node, const Balancer& balancer, TimePoint now) {
    const auto expected_seconds = [&](NodeId who, const Outstanding& entry) {
        const double rate = balancer.rate(who);
        const auto samples = static_cast<double>(entry.unit.block.count() * entry.unit.tile.pixel_count());
        return rate > 0.0 ? samples / rate : 0.0;
    };
    // When each holder will have finished all its units; overdue work counts as never.
    std::map<NodeId, double> until_done;
    for (const auto& [id, entry] : outstanding_) {
        for (const auto& [holder, since] : entry.holders) {
            const double expected = expected_seconds(holder, entry);
            until_done[holder] += expected;
            if (seconds(now - since) > 3.0 * until_done[holder] + 0.05) until_done[holder] = 1e9;
        }
    }
    auto best = outstanding_.end();
    double latest = 0.0;
    for (auto entry = outstanding_.begin(); entry != outstanding_.end(); ++entry) {
        if (entry->second.holders.size() != 1 || entry->second.holders.contains(node)) continue;
        const double done = until_done[entry->second.holders.begin()->first];
        // Take the unit that the slowest holder was given last: the least likely to have been started.
        if (done > expected_seconds(node, entry->second) && done >= latest) {
            best = entry;
            latest = done;
        }
    }
    if (best == outstanding_.end()) return std::nullopt;
    ++counts_.reissued;
    best->second.holders.emplace(node, now);
    return Assignment{node, best->second.unit};
}

void Scheduler::cut_round_for_deadline(std::span<const NodeCapacity> nodes, const Balancer& balancer,
                                       TimePoint now) {
    if (!deadline_ || !plan_.at_round_start()) return;
    double rate = 0.0;
    for (const NodeCapacity& node : nodes) rate += node.workers * balancer.rate(node.node);
    if (rate <= 0.0) return;
    const double needed = static_cast<double>(plan_.round_samples()) / rate;
    if (now + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(needed)) > *deadline_) {
        plan_.deal_round_in_eighths();
    }
}

std::vector<Cancellation> Scheduler::merged(UnitId unit, std::uint32_t tile, const SampleBlock& block) {
    std::vector<Cancellation> cancellations;
    BlockSet& ledger = ledger_.at(tile);
    const std::uint64_t before = ledger.sample_count();
    ledger.insert(block);
    if (before == 0) --tiles_without_samples_;
    merged_samples_ += (ledger.sample_count() - before) * plan_.tiles()[tile].pixel_count();
    const auto entry = outstanding_.find(unit);
    if (entry == outstanding_.end() || !ledger.covers(entry->second.unit.block)) return cancellations;
    ++counts_.merged;
    if (entry->second.holders.size() > 1) {
        for (const auto& [holder, since] : entry->second.holders) cancellations.push_back({holder, unit});
    }
    outstanding_.erase(entry);
    return cancellations;
}

void Scheduler::drop(Units::iterator entry, NodeId node, Loss loss) {
    entry->second.holders.erase(node);
    ++(loss == Loss::Lost ? counts_.lost : counts_.cancelled);
    if (!entry->second.holders.empty()) return;
    if (!closed_) {
        for (const SampleBlock& gap : ledger_[entry->second.tile].missing_in(entry->second.unit.block)) {
            plan_.give_back({entry->second.tile, gap});
        }
    }
    outstanding_.erase(entry);
}

bool Scheduler::released(UnitId unit, NodeId node, Loss loss) {
    const auto entry = outstanding_.find(unit);
    if (entry == outstanding_.end() || !entry->second.holders.contains(node)) return false;
    drop(entry, node, loss);
    return true;
}

void Scheduler::node_gone(NodeId node) {
    for (const UnitId unit : held_by(node)) released(unit, node, Loss::Lost);
}

std::vector<UnitId> Scheduler::held_by(NodeId node) const {
    std::vector<UnitId> units;
    for (const auto& [id, entry] : outstanding_) {
        if (entry.holders.contains(node)) units.push_back(id);
    }
    return units;
}

std::optional<view::WorkUnit> Scheduler::find(UnitId unit) const {
    const auto entry = outstanding_.find(unit);
    if (entry == outstanding_.end()) return std::nullopt;
    return entry->second.unit;
}

std::vector<Cancellation> Scheduler::revise(std::uint64_t revision) {
    std::vector<Cancellation> cancellations;
    while (!outstanding_.empty()) {
        const auto entry = outstanding_.begin();
        const std::map<NodeId, TimePoint> holders = entry->second.holders;
        for (auto holder = holders.begin(); holder != holders.end(); ++holder) {
            cancellations.push_back({holder->first, entry->first});
            drop(entry, holder->first, Loss::Released);  // the last one ends the entry
        }
    }
    revision_ = revision;
    return cancellations;
}

std::vector<Cancellation> Scheduler::cancel_everything() {
    closed_ = true;
    std::vector<Cancellation> cancellations;
    for (const auto& [id, entry] : outstanding_) {
        for (const auto& [holder, since] : entry.holders) cancellations.push_back({holder, id});
    }
    return cancellations;
}

void add(session::UnitCounts& to, const session::UnitCounts& from) {
    to.issued += from.issued;
    to.reissued += from.reissued;
    to.merged += from.merged;
    to.duplicate += from.duplicate;
    to.cancelled += from.cancelled;
    to.refused += from.refused;
    to.lost += from.lost;
}

}  // namespace tessera::master
