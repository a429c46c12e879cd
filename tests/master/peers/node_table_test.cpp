#include "master/peers/node_table.h"

#include <gtest/gtest.h>

namespace tessera::master {
namespace {

using namespace std::chrono_literals;

struct NodeTableTest : testing::Test {
    NodeTable table{net::LivenessSettings{}, StuckSettings{.allowance = 10s}};
    NodeRecord& node = table.add(NodeId{1}, 77, 5, "node", {.concurrent_units = 2}, TimePoint{});
};

TEST_F(NodeTableTest, CountsWorkInTransitAgainstTheFreeSlots) {
    table.heartbeat(node, {.in_flight = {UnitId{1}}, .free_slots = 3}, TimePoint{});
    node.pending = {{UnitId{2}, 1}, {UnitId{3}, 2}};
    EXPECT_EQ(node.capacity().free_slots, 1u);
    EXPECT_EQ(node.capacity().in_flight, 3u);
    // The node has seen the first of the two: it is in its queue now, the other still in flight.
    table.heartbeat(node, {.in_flight = {UnitId{1}, UnitId{2}}, .free_slots = 2, .last_work_sequence = 1},
                    TimePoint{});
    EXPECT_EQ(node.capacity().free_slots, 1u);
    EXPECT_EQ(node.pending.size(), 1u);
}

TEST_F(NodeTableTest, FindsLostUnitsOnlyAfterPatience) {
    table.heartbeat(node, {.in_flight = {UnitId{1}}, .last_work_sequence = 2}, TimePoint{});
    const std::vector<UnitId> held{UnitId{1}, UnitId{2}};
    EXPECT_TRUE(NodeTable::overdue(node, held, TimePoint{1s}, 5s).empty());
    EXPECT_TRUE(NodeTable::overdue(node, held, TimePoint{5s}, 5s).empty());
    EXPECT_EQ(NodeTable::overdue(node, held, TimePoint{7s}, 5s), std::vector{UnitId{2}});
    node.state.in_flight.push_back(UnitId{2});
    EXPECT_TRUE(NodeTable::overdue(node, held, TimePoint{9s}, 5s).empty())
        << "in its queue again: the clock restarts";
}

TEST_F(NodeTableTest, DistinguishesStuckFromIdle) {
    table.heartbeat(node, {.phase = session::NodePhase::Rendering, .progress = 5}, TimePoint{1s});
    table.heartbeat(node, {.phase = session::NodePhase::Rendering, .progress = 5}, TimePoint{12s});
    EXPECT_TRUE(node.stuck);
    table.heartbeat(node, {.phase = session::NodePhase::Rendering, .progress = 6}, TimePoint{13s});
    EXPECT_FALSE(node.stuck);
    table.heartbeat(node, {.phase = session::NodePhase::Idle, .progress = 6}, TimePoint{60s});
    EXPECT_FALSE(node.stuck);
}

TEST_F(NodeTableTest, ALongUnitAndABuildMayTakeLonger) {
    node.allowance = 60s;
    table.heartbeat(node, {.phase = session::NodePhase::Rendering}, TimePoint{1s});
    table.heartbeat(node, {.phase = session::NodePhase::Rendering}, TimePoint{60s});
    EXPECT_FALSE(node.stuck) << "its units are expected to take so long";
    table.heartbeat(node, {.phase = session::NodePhase::Rendering}, TimePoint{62s});
    EXPECT_TRUE(node.stuck);
    table.heartbeat(node, {.phase = session::NodePhase::Building}, TimePoint{63s});
    table.heartbeat(node, {.phase = session::NodePhase::Building}, TimePoint{63s + 29min});
    EXPECT_FALSE(node.stuck) << "it builds";
    node.allowance = 0s;
    table.heartbeat(node, {.phase = session::NodePhase::Rendering}, TimePoint{64s + 29min});
    EXPECT_FALSE(node.stuck) << "it has just begun to render";
    table.heartbeat(node, {.phase = session::NodePhase::Building}, TimePoint{65s + 29min});
    table.heartbeat(node, {.phase = session::NodePhase::Building}, TimePoint{66s + 59min});
    EXPECT_TRUE(node.stuck);
}

TEST_F(NodeTableTest, EchoedHeartbeatGivesRoundTripAndClockOffset) {
    table.heartbeat(node, {.sent_at = 5}, TimePoint{1s});
    EXPECT_FALSE(node.clock.offset(TimePoint{1s}));
    // Ours was sent at 2 s, stayed at the node for 0.5 s and returned at 2.6 s; the node's clock is an hour ahead.
    const std::int64_t there = (TimePoint{3602550ms}).time_since_epoch().count();
    const wire::Heartbeat beat{.sent_at = there, .echo_sent_at = 2'000'000'000, .echo_delay = 500'000'000};
    table.heartbeat(node, beat, TimePoint{2600ms});
    EXPECT_DOUBLE_EQ(node.round_trip_seconds, 0.1);
    ASSERT_TRUE(node.clock.offset(TimePoint{2600ms}));
    EXPECT_EQ(node.clock.offset(TimePoint{2600ms})->offset, 1h);
    table.heartbeat(node, {.sent_at = there, .echo_sent_at = -1, .echo_delay = INT64_MIN}, TimePoint{3s});
    EXPECT_DOUBLE_EQ(node.round_trip_seconds, 0.1);
}

TEST_F(NodeTableTest, SilentNodesTimeOut) {
    node.liveness.on_message(TimePoint{1s});
    EXPECT_TRUE(table.timed_out(TimePoint{3s}).empty());
    EXPECT_EQ(table.timed_out(TimePoint{5s}), std::vector{NodeId{1}});
}

}  // namespace
}  // namespace tessera::master
