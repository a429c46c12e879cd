#include <gtest/gtest.h>

#include <algorithm>

#include "tests/master/render/simulated_cluster.h"

namespace tessera::master {
namespace {

PlanSettings picture(session::Policy policy, std::uint64_t spp = 64) {
    return {.window = {0, 0, 320, 200}, .tile = 32, .spp = spp, .policy = policy, .first_level = 2};
}

class SchedulerUnder : public testing::TestWithParam<session::Policy> {};

TEST_P(SchedulerUnder, FinishesUnequalNodesTogether) {
    SimulatedCluster cluster({{.rate = 1e5}, {.rate = 1e6}, {.rate = 3e5}}, picture(GetParam()));
    const double makespan = cluster.run();
    EXPECT_TRUE(cluster.is_covered(64));
    const double ideal = 320.0 * 200 * 64 / 1.4e6;
    EXPECT_LT(makespan, 1.1 * ideal) << "stragglers are not hidden";
    for (std::size_t node = 0; node < 3; ++node) EXPECT_GT(cluster.samples_of(node), 0u);
}

TEST_P(SchedulerUnder, SurvivesLostNodesAndCountsThem) {
    SimulatedCluster cluster({{.rate = 2e5, .dies_at = 3.0}, {.rate = 2e5}, {.rate = 2e5, .dies_at = 5.0}},
                             picture(GetParam(), 50));
    cluster.run();
    EXPECT_TRUE(cluster.is_covered(50));
    const session::UnitCounts counts = cluster.scheduler().counts();
    EXPECT_GT(counts.lost, 0u);
    EXPECT_GT(counts.reissued, 0u);
    EXPECT_EQ(cluster.scheduler().merged_samples(), 320u * 200u * 50u);
    EXPECT_EQ(counts.issued + counts.reissued,
              counts.merged + counts.duplicate + counts.cancelled + counts.refused + counts.lost);
}

TEST_P(SchedulerUnder, DuplicatesTheLastUnitsOfAStuckNode) {
    SimulatedCluster cluster({{.rate = 5.0}, {.rate = 1e6}}, picture(GetParam(), 16));
    const double makespan = cluster.run();
    EXPECT_TRUE(cluster.is_covered(16));
    EXPECT_LT(makespan, 10.0) << "a unit of the slow node alone takes minutes";
}

// Two stuck nodes hold the same unit: a third gets it.
TEST_P(SchedulerUnder, RescuesAUnitFromTwoStuckNodes) {
    SimulatedCluster cluster({{.rate = 1e6, .slow_from = 0.02, .slow_factor = 1e-6},
                              {.rate = 1e6, .slow_from = 0.02, .slow_factor = 1e-6},
                              {.rate = 1e4}},
                             picture(GetParam(), 1));
    EXPECT_LT(cluster.run(), 60.0);
    EXPECT_TRUE(cluster.is_covered(1));
}

// Film on the wire must not grow with the number of nodes.
TEST_P(SchedulerUnder, NeedsHardlyMoreFilmForMoreNodes) {
    const auto films_per_tile = [](std::size_t nodes) {
        std::vector<SimulatedCluster::Node> all(nodes, {.rate = 5e5, .latency = 1e-3});
        SimulatedCluster cluster(
            all,
            {.window = {0, 0, 1280, 720}, .tile = 64, .spp = 64, .policy = GetParam(), .first_level = 2});
        const double makespan = cluster.run();
        EXPECT_TRUE(cluster.is_covered(64));
        const double ideal = 1280.0 * 720 * 64 / (5e5 * static_cast<double>(nodes));
        EXPECT_LT(makespan, 1.05 * ideal + 0.25) << nodes;
        return static_cast<double>(cluster.films()) / static_cast<double>(cluster.scheduler().tiles().size());
    };
    const double one = films_per_tile(1);
    EXPECT_LE(one, 6.0);
    if (GetParam() == session::Policy::Cooperative) return;  // splits tiles on request
    for (const std::size_t nodes : {2u, 16u, 64u}) EXPECT_LE(films_per_tile(nodes), 1.2 * one) << nodes;
}

// A tile on which every node fails is given up, and costs no node more than one attempt; the rest finishes.
TEST_P(SchedulerUnder, GivesUpATileThatFailsOnTwoNodes) {
    std::vector<SimulatedCluster::Node> nodes(3, {.rate = 1e6, .fails_on = {7}});
    SimulatedCluster cluster(nodes, picture(GetParam(), 16));
    cluster.run();
    ASSERT_TRUE(cluster.scheduler().complete());
    ASSERT_EQ(cluster.scheduler().failed_tiles().size(), 1u);
    EXPECT_EQ(cluster.scheduler().failed_tiles()[0].tile, 7u);
    EXPECT_EQ(cluster.scheduler().failed_tiles()[0].message, "it fails");
    EXPECT_EQ(cluster.scheduler().tiles_without_samples(), 0u) << "none that waits for samples";
    EXPECT_EQ(cluster.scheduler().merged_samples(), (320u * 200u - 32u * 32u) * 16u);
    const session::UnitCounts counts = cluster.scheduler().counts();
    EXPECT_GE(counts.refused, 2u);
    EXPECT_EQ(counts.issued + counts.reissued,
              counts.merged + counts.duplicate + counts.cancelled + counts.refused + counts.lost);
}

// A node that fails everything at once attracts units: others render them.
TEST_P(SchedulerUnder, OthersRenderWhatOneNodeFails) {
    std::vector<SimulatedCluster::Node> nodes(3, {.rate = 1e6});
    nodes[1].rate = 1e12;
    for (std::uint32_t tile = 0; tile < 70; ++tile) nodes[1].fails_on.insert(tile);
    SimulatedCluster cluster(nodes, picture(GetParam(), 16));
    cluster.run();
    EXPECT_TRUE(cluster.is_covered(16));
    EXPECT_TRUE(cluster.scheduler().failed_tiles().empty());
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
    const auto cancelled = scheduler.merged(NodeId{2}, 0, {0, 0});
    ASSERT_EQ(cancelled.size(), 1u);
    EXPECT_EQ(cancelled[0].node, NodeId{1});
    EXPECT_TRUE(scheduler.complete());
}

// The fastest node, as it says, keeps samples that may have cost a node from no other.
TEST(Scheduler, DoubtfulSamplesDoNotWaitForANodeThatTakesNothing) {
    Scheduler scheduler({.window = {0, 0, 8, 8}, .tile = 8, .spp = 1}, ViewId{1}, 1, {1, 1}, UnitId{1},
                        std::nullopt);
    Balancer balancer;
    for (const std::uint64_t node : {1u, 2u, 3u})
        balancer.measured(NodeId{node}, node == 1 ? 1'000'000'000'000 : 1'000'000, std::chrono::seconds(1));
    const NodeCapacity idle{.node = NodeId{1}}, first{.node = NodeId{2}, .free_slots = 1},
        second{.node = NodeId{3}, .free_slots = 1};
    ASSERT_EQ(scheduler.assign(std::vector{idle, first}, balancer, {}).size(), 1u);
    scheduler.node_gone({.node = first.node,
                         .rendering = 1,
                         .has_ended = true,
                         .now = TimePoint{std::chrono::seconds(1)},
                         .describe = {}});
    const auto again =
        scheduler.assign(std::vector{idle, second}, balancer, TimePoint{std::chrono::seconds(1)});
    ASSERT_EQ(again.size(), 1u);
    EXPECT_EQ(again[0].node, second.node);
}

// Samples kill two nodes that have them, and the second death has not been noticed yet: they are not dealt to a third one. A
// node whose heartbeats go on is slow.
TEST(Scheduler, DoubtfulSamplesCostNoThirdNodeBeforeADeathIsNoticed) {
    for (const bool is_slow : {false, true}) {
        Scheduler scheduler({.window = {0, 0, 8, 8}, .tile = 8, .spp = 1}, ViewId{1}, 1, {1, 1}, UnitId{1},
                            std::nullopt);
        Balancer balancer;
        for (const std::uint64_t node : {1u, 2u, 3u})
            balancer.measured(NodeId{node}, 1'000'000, std::chrono::seconds(1));
        const auto at = [](int s) { return TimePoint{std::chrono::seconds(s)}; };
        const auto nodes = [&](std::uint64_t idle, int heartbeat) {
            std::vector<NodeCapacity> all;
            for (std::uint64_t node = 1; node <= idle; ++node)
                all.push_back(
                    {.node = NodeId{node}, .free_slots = node == idle, .heartbeat_at = at(heartbeat)});
            return all;
        };
        ASSERT_EQ(scheduler.assign(nodes(1, 1), balancer, at(1)).size(), 1u);
        ASSERT_EQ(scheduler.assign(nodes(2, 1), balancer, at(10)).size(), 1u) << "the first is late";
        scheduler.node_gone(
            {.node = NodeId{1}, .rendering = 1, .has_ended = true, .now = at(11), .describe = {}});
        const auto third = scheduler.assign(nodes(3, is_slow ? 20 : 10), balancer, at(20));
        EXPECT_EQ(third.size(), is_slow ? 1u : 0u);
    }
}

TEST(Scheduler, SamplesMayCostAsManyNodesAsThePlanSays) {
    for (const std::uint32_t max_crashes : {2u, 3u, 7u}) {
        Scheduler scheduler({.window = {0, 0, 8, 8}, .tile = 8, .spp = 1, .max_crashes = max_crashes},
                            ViewId{1}, 1, {1, 1}, UnitId{1}, std::nullopt);
        Balancer balancer;
        std::uint32_t crashes = 0;
        while (scheduler.failed_tiles().empty() && crashes < 20) {
            const NodeId node{++crashes};
            const auto at = [&](int s) { return TimePoint{std::chrono::seconds(10 * int(crashes) + s)}; };
            const std::vector<NodeCapacity> idle{{.node = node, .free_slots = 1, .heartbeat_at = at(0)}};
            ASSERT_EQ(scheduler.assign(idle, balancer, at(0)).size(), 1u) << crashes;
            scheduler.node_gone(
                {.node = node, .rendering = 1, .has_ended = true, .now = at(1), .describe = {}});
        }
        EXPECT_EQ(crashes, max_crashes);
    }
}

TEST(Scheduler, PartlyFinishedUnitReturnsItsMissingSamples) {
    Scheduler scheduler({.window = {0, 0, 8, 8}, .tile = 8, .spp = 16, .first_level = 4}, ViewId{1}, 1,
                        {1, 1}, UnitId{1}, std::nullopt);
    Balancer balancer(Balancer::Settings{.first_samples = 1e9});
    const NodeCapacity node{NodeId{1}, 1, 1, 0};
    const auto unit = scheduler.assign(std::vector{node}, balancer, TimePoint{}).at(0).unit;
    scheduler.merged(NodeId{1}, 0, {unit.block.first, 0});
    EXPECT_TRUE(scheduler.end(unit.id, NodeId{1}, Fate::Cancelled));
    EXPECT_FALSE(scheduler.end(unit.id, NodeId{1}, Fate::Cancelled));
    std::uint64_t dealt = 0;
    for (const Assignment& next :
         scheduler.assign(std::vector{NodeCapacity{NodeId{1}, 1, 100, 0}}, balancer, TimePoint{})) {
        EXPECT_NE(next.unit.block.first, unit.block.first);
        dealt += next.unit.block.count();
    }
    EXPECT_EQ(dealt, 15u);
}

// By its own account a node needs centuries for a round.
TEST(Scheduler, ADeadlineHoldsWhateverRateANodeClaims) {
    for (const Duration busy : {Duration(std::chrono::hours(1)), Duration::max()}) {
        Scheduler scheduler({.window = {0, 0, 64, 64}, .tile = 64, .spp = 1u << 20, .first_level = 10},
                            ViewId{1}, 1, {1, 1}, UnitId{1}, TimePoint{} + std::chrono::seconds(10));
        Balancer balancer(Balancer::Settings{.first_samples = 1e9});
        balancer.measured(NodeId{1}, 1, busy);
        const auto one = scheduler.assign(std::vector{NodeCapacity{NodeId{1}, 1, 1, 0}}, balancer, {});
        ASSERT_EQ(one.size(), 1u);
        for (const Assignment& next :
             scheduler.assign(std::vector{NodeCapacity{NodeId{2}, 1, 10, 0}}, balancer, {}))
            EXPECT_LE(next.unit.block.level, 7u) << "the round was not cut";
    }
}

TEST(Scheduler, DealsNoMoreAfterCancellingEverything) {
    Scheduler scheduler({.window = {0, 0, 64, 64}, .tile = 8, .spp = 4}, ViewId{1}, 1, {1, 1}, UnitId{1},
                        std::nullopt);
    Balancer balancer;
    const NodeCapacity node{NodeId{1}, 1, 3, 0};
    const auto units = scheduler.assign(std::vector{node}, balancer, TimePoint{});
    EXPECT_EQ(scheduler.cancel_everything().size(), units.size());
    EXPECT_TRUE(scheduler.assign(std::vector{node}, balancer, TimePoint{}).empty());
    for (const auto& assignment : units) scheduler.end(assignment.unit.id, NodeId{1}, Fate::Cancelled);
    EXPECT_TRUE(scheduler.idle());
}

// Film may arrive right before, or right after, the node confirms that its unit is cancelled.
TEST(Scheduler, TheFilmStaysThatOfTheCountedSamplesOnceItIsSealed) {
    Scheduler scheduler({.window = {0, 0, 16, 8}, .tile = 8, .spp = 4}, ViewId{1}, 1, {1, 1}, UnitId{1},
                        std::nullopt);
    Balancer balancer;
    const auto units = scheduler.assign(std::vector{NodeCapacity{NodeId{1}, 1, 2, 0}}, balancer, TimePoint{});
    ASSERT_EQ(units.size(), 2u);
    const auto admit = [&](const view::WorkUnit& unit) {
        return scheduler.admit(NodeId{1}, {unit.id, unit.version, unit.tile, unit.block});
    };
    scheduler.cancel_everything();
    const Admission first = admit(units[0].unit);
    for (const auto& assignment : units) scheduler.end(assignment.unit.id, NodeId{1}, Fate::Cancelled);
    EXPECT_TRUE(scheduler.idle());
    EXPECT_TRUE(scheduler.is_merging()) << "its samples are not counted yet";
    scheduler.merge_ended();
    scheduler.merged(NodeId{1}, first.tile, units[0].unit.block);
    EXPECT_FALSE(scheduler.is_merging());
    const std::uint64_t samples = scheduler.merged_samples();
    scheduler.seal();
    const Admission late = admit(units[1].unit);
    EXPECT_EQ(late.problem, "");
    EXPECT_EQ(late.use, Admission::Use::Drop);
    EXPECT_EQ(admit(units[0].unit).use, Admission::Use::Merge) << "another copy is compared";
    EXPECT_EQ(scheduler.merged_samples(), samples);
}

}  // namespace
}  // namespace tessera::master
