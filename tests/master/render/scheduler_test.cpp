#include "master/render/schedule/scheduler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <set>

#include "mediator/base/random.h"

namespace tessera::master {
namespace {

// A simulated cluster in simulated time: each node renders its queue in order at its own rate.
class Simulation {
  public:
    struct Node {
        double rate = 1e5;  // pixel samples per second
        std::uint32_t slots = 2;
        std::deque<view::WorkUnit> queue;
        double busy_until = 0;
        bool alive = true;
        double dies_at = 1e9;
        std::uint64_t samples = 0;
    };

    Simulation(std::vector<Node> nodes, PlanSettings plan)
        : nodes_(std::move(nodes)),
          scheduler_(plan, ViewId{1}, 1, Version{1, 1}, UnitId{1}, std::nullopt),
          coverage_(scheduler_.tiles().size()) {}

    // Runs to the end; the makespan in seconds.
    double run() {
        double now = 0;
        int guard = 0;
        while (!scheduler_.complete() && ++guard < 1'000'000) {
            deal(now);
            double next = 1e9;
            std::size_t who = nodes_.size();
            for (std::size_t i = 0; i < nodes_.size(); ++i) {
                Node& node = nodes_[i];
                if (!node.alive || node.queue.empty()) continue;
                const double done =
                    std::max(node.busy_until, started_[i]) + samples(node.queue.front()) / node.rate;
                if (std::min(done, node.dies_at) < next) {
                    next = std::min(done, node.dies_at);
                    who = i;
                }
            }
            if (who == nodes_.size()) break;
            now = next;
            if (now >= nodes_[who].dies_at) {
                kill(who);
            } else {
                finish(who, now);
            }
        }
        return now;
    }

    Scheduler& scheduler() { return scheduler_; }
    const std::vector<Node>& nodes() const { return nodes_; }
    bool covered(std::uint64_t spp) const {
        return std::all_of(coverage_.begin(), coverage_.end(),
                           [&](const BlockSet& tile) { return tile.sample_count() == spp; });
    }

  private:
    static double samples(const view::WorkUnit& unit) {
        return static_cast<double>(unit.block.count() * unit.tile.pixel_count());
    }
    static TimePoint time(double now) { return TimePoint(Duration(static_cast<std::int64_t>(now * 1e9))); }

    void deal(double now) {
        std::vector<NodeCapacity> capacities;
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            const Node& node = nodes_[i];
            if (!node.alive) continue;
            capacities.push_back({NodeId{i + 1}, 1,
                                  node.slots - static_cast<std::uint32_t>(node.queue.size()),
                                  static_cast<std::uint32_t>(node.queue.size())});
        }
        for (const Assignment& assignment : scheduler_.assign(capacities, balancer_, time(now))) {
            const std::size_t i = assignment.node.value - 1;
            if (nodes_[i].queue.empty()) started_[i] = now;
            nodes_[i].queue.push_back(assignment.unit);
            EXPECT_LE(nodes_[i].queue.size(), nodes_[i].slots);
        }
    }

    void finish(std::size_t who, double now) {
        Node& node = nodes_[who];
        const view::WorkUnit unit = node.queue.front();
        node.queue.pop_front();
        node.busy_until = now;
        started_[who] = now;
        node.samples += static_cast<std::uint64_t>(samples(unit));
        balancer_.measured(NodeId{who + 1}, static_cast<std::uint64_t>(samples(unit)),
                           Duration(static_cast<std::int64_t>(samples(unit) / node.rate * 1e9)));
        const auto& tiles = scheduler_.tiles();
        const auto tile =
            static_cast<std::uint32_t>(std::find(tiles.begin(), tiles.end(), unit.tile) - tiles.begin());
        coverage_[tile].insert(unit.block);
        for (const Cancellation& cancellation : scheduler_.merged(unit.id, tile, unit.block)) {
            auto& queue = nodes_[cancellation.node.value - 1].queue;
            std::erase_if(queue, [&](const auto& held) { return held.id == cancellation.unit; });
        }
    }

    void kill(std::size_t who) {
        nodes_[who].alive = false;
        nodes_[who].queue.clear();
        balancer_.forget(NodeId{who + 1});
        scheduler_.node_gone(NodeId{who + 1});
    }

    std::vector<Node> nodes_;
    Scheduler scheduler_;
    Balancer balancer_;
    std::vector<BlockSet> coverage_;
    std::map<std::size_t, double> started_;
};

PlanSettings picture(session::Policy policy, std::uint64_t spp = 64) {
    return {.window = {0, 0, 320, 200}, .tile = 32, .spp = spp, .policy = policy, .first_level = 2};
}

class SchedulerUnder : public testing::TestWithParam<session::Policy> {};

TEST_P(SchedulerUnder, FinishesUnequalNodesTogether) {
    Simulation simulation({{.rate = 1e5}, {.rate = 1e6}, {.rate = 3e5}}, picture(GetParam()));
    const double makespan = simulation.run();
    EXPECT_TRUE(simulation.covered(64));
    const double ideal = 320.0 * 200 * 64 / 1.4e6;
    EXPECT_LT(makespan, 1.15 * ideal) << "stragglers are not hidden";
    for (const auto& node : simulation.nodes()) EXPECT_GT(node.samples, 0u);
}

TEST_P(SchedulerUnder, SurvivesLostNodesAndCountsThem) {
    Simulation simulation({{.rate = 2e5, .dies_at = 3.0}, {.rate = 2e5}, {.rate = 2e5, .dies_at = 5.0}},
                          picture(GetParam(), 50));
    simulation.run();
    EXPECT_TRUE(simulation.covered(50));
    const auto& counts = simulation.scheduler().counts();
    EXPECT_GT(counts.lost, 0u);
    EXPECT_GT(counts.reissued, 0u);
    EXPECT_EQ(simulation.scheduler().merged_samples(), 320u * 200u * 50u);
}

TEST_P(SchedulerUnder, DuplicatesTheLastUnitsOfAStuckNode) {
    Simulation simulation({{.rate = 5.0}, {.rate = 1e6}}, picture(GetParam(), 16));
    const double makespan = simulation.run();
    EXPECT_TRUE(simulation.covered(16));
    EXPECT_LT(makespan, 10.0) << "a unit of the slow node alone takes minutes";
}

INSTANTIATE_TEST_SUITE_P(Policies, SchedulerUnder,
                         testing::Values(session::Policy::Tiled, session::Policy::Cooperative,
                                         session::Policy::Mixed));

TEST(Scheduler, CancelsTheOtherHolderOfADuplicate) {
    Scheduler scheduler({.window = {0, 0, 8, 8}, .tile = 8, .spp = 1}, ViewId{1}, 1, {1, 1}, UnitId{1},
                        std::nullopt);
    Balancer balancer;
    balancer.measured(NodeId{1}, 64, std::chrono::seconds(64));
    balancer.measured(NodeId{2}, 6400, std::chrono::seconds(1));
    const NodeCapacity slow{NodeId{1}, 1, 1, 0}, fast{NodeId{2}, 1, 1, 0};
    const auto first = scheduler.assign(std::vector{slow}, balancer, TimePoint{});
    ASSERT_EQ(first.size(), 1u);
    const auto second = scheduler.assign(std::vector{fast}, balancer, TimePoint{});
    ASSERT_EQ(second.size(), 1u);
    EXPECT_EQ(second[0].unit, first[0].unit);
    EXPECT_TRUE(
        scheduler.assign(std::vector{NodeCapacity{NodeId{3}, 1, 1, 0}}, balancer, TimePoint{}).empty())
        << "two holders are enough";
    const auto cancelled = scheduler.merged(first[0].unit.id, 0, {0, 0});
    EXPECT_EQ(cancelled.size(), 2u);
    EXPECT_TRUE(scheduler.complete());
}

TEST(Scheduler, PartlyFinishedUnitReturnsItsMissingSamples) {
    Scheduler scheduler({.window = {0, 0, 8, 8}, .tile = 8, .spp = 16, .first_level = 4}, ViewId{1}, 1,
                        {1, 1}, UnitId{1}, std::nullopt);
    Balancer balancer(Balancer::Settings{.first_samples = 1e9});
    const NodeCapacity node{NodeId{1}, 1, 1, 0};
    const auto unit = scheduler.assign(std::vector{node}, balancer, TimePoint{}).at(0).unit;
    scheduler.merged(unit.id, 0, {unit.block.first, 0});
    EXPECT_TRUE(scheduler.released(unit.id, NodeId{1}, Scheduler::Loss::Released));
    EXPECT_FALSE(scheduler.released(unit.id, NodeId{1}, Scheduler::Loss::Released));
    std::uint64_t dealt = 0;
    for (const Assignment& next :
         scheduler.assign(std::vector{NodeCapacity{NodeId{1}, 1, 100, 0}}, balancer, TimePoint{})) {
        EXPECT_NE(next.unit.block.first, unit.block.first);
        dealt += next.unit.block.count();
    }
    EXPECT_EQ(dealt, 15u);
}

TEST(Scheduler, DealsNoMoreAfterCancellingEverything) {
    Scheduler scheduler({.window = {0, 0, 64, 64}, .tile = 8, .spp = 4}, ViewId{1}, 1, {1, 1}, UnitId{1},
                        std::nullopt);
    Balancer balancer;
    const NodeCapacity node{NodeId{1}, 1, 3, 0};
    const auto units = scheduler.assign(std::vector{node}, balancer, TimePoint{});
    EXPECT_EQ(scheduler.cancel_everything().size(), units.size());
    EXPECT_TRUE(scheduler.assign(std::vector{node}, balancer, TimePoint{}).empty());
    for (const auto& assignment : units)
        scheduler.released(assignment.unit.id, NodeId{1}, Scheduler::Loss::Released);
    EXPECT_TRUE(scheduler.idle());
}

}  // namespace
}  // namespace tessera::master
