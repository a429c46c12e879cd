#include "master/render/schedule/forecast.h"

#include <algorithm>
#include <functional>
#include <queue>

namespace tessera::master {

Forecast::Forecast(const UnitLedger& ledger, std::span<const NodeCapacity> nodes, const Balancer& balancer,
                   TimePoint now) {
    for (const NodeCapacity& node : nodes)
        holders_.push_back({.node = node.node,
                            .workers = std::max(1u, node.workers),
                            .round_trip = node.round_trip_seconds,
                            .heartbeat_at = node.heartbeat_at,
                            .items = {}});
    std::ranges::sort(holders_, {}, &Holder::node);
    for (const auto& [id, unit] : ledger.open()) {
        const std::size_t index = unit.is_covered ? NotAwaited : awaited_.size();
        const auto samples = static_cast<double>(unit.unit.pixel_samples());
        for (const auto& [node, since] : unit.holders) {
            const double rate = balancer.rate(node);
            holder(node).items.push_back({index, since, rate > 0.0 ? samples / rate : 0.0, 0.0});
        }
        if (index != NotAwaited) awaited_.push_back({.unit = &unit});
    }
    for (Holder& one : holders_) {
        foresee(one, 0.5 * balancer.unit_seconds(), now);
        for (const Item& item : one.items) {
            if (item.awaited == NotAwaited) continue;
            Awaited& unit = awaited_[item.awaited];
            unit.done = std::min(unit.done, item.end);
            unit.all_are_late = unit.all_are_late && one.is_late;
            unit.all_are_slow = unit.all_are_slow && one.is_slow;
        }
    }
}

// It renders its units in the order in which it got them, and sends the film of consecutive ones together.
void Forecast::foresee(Holder& holder, double slack, TimePoint now) {
    std::ranges::stable_sort(holder.items, {}, &Item::since);
    std::priority_queue<double, std::vector<double>, std::greater<>> free;  // when each worker is
    double last = -Never;
    for (Item& item : holder.items) {
        double start = 0.5 * holder.round_trip - seconds(now - item.since);
        if (free.size() == holder.workers) {
            start = std::max(start, free.top());
            free.pop();
        }
        free.push(start + item.expected);
        last = std::max(last, start + item.expected);
        item.end = std::max(start + item.expected, 0.0) + 0.5 * holder.round_trip;
    }
    const double late = -(last + 0.5 * holder.round_trip);
    holder.is_late = !holder.items.empty() && late > slack;
    if (!holder.is_late) return;
    holder.is_slow = late - seconds(now - holder.heartbeat_at) > slack;
    // What has taken that much longer than expected may take as long again.
    for (Item& item : holder.items) item.end = std::max(item.expected, late) + 0.5 * holder.round_trip;
}

Forecast::Holder& Forecast::holder(NodeId node) {
    const auto place = std::ranges::lower_bound(holders_, node, {}, &Holder::node);
    if (place != holders_.end() && place->node == node) return *place;
    return *holders_.insert(place, Holder{.node = node, .items = {}});
}

const Forecast::Holder* Forecast::find(NodeId node) const {
    const auto place = std::ranges::lower_bound(holders_, node, {}, &Holder::node);
    return place != holders_.end() && place->node == node ? &*place : nullptr;
}

bool Forecast::is_late(NodeId node) const {
    const Holder* holder = find(node);
    return holder != nullptr && holder->is_late;
}

double Forecast::expected_seconds(const Balancer& balancer, const NodeCapacity& node, std::uint64_t samples) {
    const double rate = balancer.rate(node.node);
    return node.round_trip_seconds + (rate > 0.0 ? static_cast<double>(samples) / rate : 0.0);
}

}  // namespace tessera::master
