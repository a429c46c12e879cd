#pragma once

#include <span>
#include <vector>

#include "master/peers/node_capacity.h"
#include "master/render/schedule/balancer.h"
#include "master/render/schedule/unit_ledger.h"

namespace tessera::master {

// When the nodes will have rendered the units that they hold, as far as their rates tell. Pure.
class Forecast {
  public:
    static constexpr double Never = 1e9;

    struct Awaited {
        const UnitLedger::Unit* unit = nullptr;
        double done = Never;       // s from now, when its film arrives from the first of its holders
        bool all_are_late = true;  // its holders
        bool all_are_slow = true;  // the same, and each has sent a heartbeat since: none has died unnoticed
    };

    Forecast(const UnitLedger& ledger, std::span<const NodeCapacity> nodes, const Balancer& balancer,
             TimePoint now);

    // Units whose samples have not arrived, in the order of dealing.
    const std::vector<Awaited>& awaited() const { return awaited_; }
    // Everything that it holds should have arrived some time ago: it has become slower, stands still or is dead.
    bool is_late(NodeId node) const;

    // s until film of that many pixel samples arrives from the node, if it begins at once.
    static double expected_seconds(const Balancer& balancer, const NodeCapacity& node, std::uint64_t samples);
    // It was dealt to one more node, and is no longer what arrives last.
    void dealt_again(std::size_t awaited) { awaited_[awaited] = {awaited_[awaited].unit, 0.0, false, false}; }

  private:
    // Others have rendered it, and its holder, which was asked to stop, has not said that it has.
    static constexpr std::size_t NotAwaited = ~std::size_t{0};
    struct Item {
        std::size_t awaited;
        TimePoint since;
        double expected, end;
    };
    struct Holder {
        NodeId node;
        std::uint32_t workers = 1;
        double round_trip = 0.0;
        TimePoint heartbeat_at{};
        bool is_late = false, is_slow = false;
        std::vector<Item> items;
    };
    Holder& holder(NodeId node);
    const Holder* find(NodeId node) const;
    void foresee(Holder& holder, double slack, TimePoint now);

    std::vector<Holder> holders_;  // ascending
    std::vector<Awaited> awaited_;
};

}  // namespace tessera::master
