#include "master/scene/edit_trace.h"

#include <gtest/gtest.h>

#include <limits>

namespace tessera::master {

namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t Epoch = 9;

struct EditTraceTest : testing::Test {
    EditTraceLog log;
    std::uint64_t transaction = 0;
    // The client's clock is 100 s ahead, the node's 5 s behind.
    net::ClockOffset client{100s, 1ms}, node_clock{-5s, 2ms};

    static TimePoint at(Duration since) { return TimePoint{1000s} + since; }
    static std::int64_t ns(TimePoint time) { return time.time_since_epoch().count(); }
    static Version version(std::uint64_t number) { return {Epoch, number}; }

    void edit(std::uint64_t number, Duration left, Duration came) {
        log.submitted({.transaction = ++transaction,
                       .name = "anna",
                       .bytes = 50,
                       .submitted_at = ns(at(left) + 100s),
                       .clock = client,
                       .received = at(came),
                       .version = version(number)});
    }
    void built(std::uint64_t node, std::uint64_t number, Duration came, Duration ready) {
        log.node_built(NodeId{node}, "n" + std::to_string(node), version(number), ns(at(came) - 5s),
                       ns(at(ready) - 5s), node_clock);
    }
    session::StageTimes stage(const std::string& name) const {
        for (const session::StageTimes& stage : log.stages()) {
            if (stage.name == name) return stage;
        }
        ADD_FAILURE() << "no stage " << name;
        return {};
    }
};

TEST_F(EditTraceTest, FollowsAnEditInTheMastersClock) {
    built(1, 1, -1s, -1s);  // it was there before
    edit(2, 0ms, 3ms);
    log.published(version(2), at(10ms));
    built(1, 2, 12ms, 19ms);
    log.merged(version(2), at(40ms));
    const auto trace = log.latest(10);
    ASSERT_EQ(trace.size(), 1u);
    const session::EditTrace& e = trace[0];
    EXPECT_EQ(e.transaction, 1u);
    EXPECT_EQ(e.name, "anna");
    EXPECT_EQ(e.submitted, ns(at(0ms)));
    EXPECT_EQ(e.bound, Duration(1ms).count());
    EXPECT_EQ(e.received, ns(at(3ms)));
    EXPECT_EQ(e.published, ns(at(10ms)));
    ASSERT_EQ(e.nodes.size(), 1u);
    EXPECT_EQ(e.nodes[0].name, "n1");
    EXPECT_EQ(e.nodes[0].received, ns(at(12ms)));
    EXPECT_EQ(e.nodes[0].built, ns(at(19ms)));
    EXPECT_EQ(e.nodes[0].bound, Duration(2ms).count());
    EXPECT_EQ(e.merged, ns(at(40ms)));
    EXPECT_NEAR(stage("client to master").p50_seconds, 0.003, 1e-9);
    EXPECT_NEAR(stage("master to published").p50_seconds, 0.007, 1e-9);
    EXPECT_NEAR(stage("published to node").p50_seconds, 0.002, 1e-9);
    EXPECT_NEAR(stage("node to built").p50_seconds, 0.007, 1e-9);
    EXPECT_NEAR(stage("built to picture").p50_seconds, 0.021, 1e-9);
    EXPECT_NEAR(stage("whole").p99_seconds, 0.040, 1e-9);
}

TEST_F(EditTraceTest, AVersionHoldsAllEditsUpToItAndEachIsTimedOnce) {
    built(1, 1, 0ms, 0ms);
    edit(2, 0ms, 1ms);
    edit(2, 1ms, 2ms);
    edit(3, 2ms, 3ms);
    edit(4, 3ms, 4ms);
    log.published(version(3), at(5ms));
    log.merged(version(2), at(6ms));
    log.merged(version(3), at(7ms));
    log.published(version(4), at(8ms));
    built(1, 4, 9ms, 10ms);  // three lists in one build
    log.merged(version(4), at(11ms));
    log.merged(version(4), at(99ms));  // not the first
    const auto trace = log.latest(10);
    ASSERT_EQ(trace.size(), 4u);
    const std::vector<Duration> published{5ms, 5ms, 5ms, 8ms}, merged{6ms, 6ms, 7ms, 11ms};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(trace[i].published, ns(at(published[i]))) << i;
        EXPECT_EQ(trace[i].merged, ns(at(merged[i]))) << i;
        EXPECT_EQ(trace[i].nodes.size(), 1u) << i;
    }
    EXPECT_EQ(log.latest(1)[0].transaction, 4u);
    EXPECT_EQ(log.edit_bytes(), 200u);
    EXPECT_EQ(stage("whole").count, 4u);
}

TEST_F(EditTraceTest, LateNodeDelaysNoEdit) {
    edit(2, 0ms, 1ms);
    log.published(version(2), at(2ms));
    built(1, 2, 60s, 61s);  // its first report
    edit(3, 62s, 62s);
    log.published(version(3), at(62s));
    built(1, 3, 62s, 62s);
    log.node_gone(NodeId{1});
    edit(4, 63s, 63s);
    built(1, 4, 64s, 64s);  // as a new one
    const auto trace = log.latest(3);
    EXPECT_EQ(trace[0].nodes.size(), 0u);
    EXPECT_EQ(trace[1].nodes.size(), 1u);
    EXPECT_EQ(trace[2].nodes.size(), 0u);
}

TEST_F(EditTraceTest, WithoutViewsNoPictureIsWaitedFor) {
    edit(2, 0ms, 1ms);
    log.no_open_views();
    edit(3, 60s, 60s);
    log.merged(version(3), at(60050ms));
    EXPECT_EQ(log.latest(2)[0].merged, 0);
    EXPECT_EQ(log.latest(2)[1].merged, ns(at(60050ms)));
    EXPECT_EQ(stage("whole").count, 1u);
}

TEST_F(EditTraceTest, UnknownEditsAreNotCounted) {
    log.submitted(
        {.transaction = 1, .submitted_at = 0, .clock = client, .received = at(0ms), .version = version(1)});
    log.submitted(
        {.transaction = 2, .submitted_at = 77, .clock = {}, .received = at(0ms), .version = version(1)});
    log.merged(version(1), at(5ms));
    for (const session::EditTrace& e : log.latest(2)) EXPECT_EQ(e.submitted, 0);
    EXPECT_EQ(stage("client to master").count, 0u);
    EXPECT_EQ(stage("client to master").p99_seconds, 0.0);
    EXPECT_EQ(stage("whole").count, 0u);
}

TEST_F(EditTraceTest, KeepsTheLatestAndCountsAll) {
    built(1, 1, 0ms, 0ms);
    for (std::uint64_t i = 0; i < 10'000; ++i) edit(2 + i, 0ms, 1ms);
    EXPECT_EQ(log.latest(100'000).size(), EditTraceLog::MaxEdits);
    EXPECT_EQ(log.latest(1)[0].version.number, 10'001u);
    EXPECT_EQ(log.edit_count(), 10'000u);
    log.published(version(10'001), at(2ms));  // most of them are not kept any more
    built(1, 10'000, 3ms, 4ms);
    log.merged(version(9'999), at(5ms));
    EXPECT_EQ(log.latest(1)[0].nodes.size(), 0u);
    EXPECT_EQ(log.latest(2)[0].nodes.size(), 1u);
    EXPECT_EQ(stage("whole").count, EditTraceLog::MaxEdits - 2);
}

TEST_F(EditTraceTest, PercentilesAreNearestRanks) {
    for (std::uint64_t i = 1; i <= 200; ++i) edit(i, -Duration(i * 1'000'000), 0ms);
    EXPECT_NEAR(stage("client to master").p50_seconds, 0.100, 1e-9);
    EXPECT_NEAR(stage("client to master").p99_seconds, 0.198, 1e-9);
}

TEST_F(EditTraceTest, TimesAreNeverNegativeAndInvalidReportsDoNotOverflow) {
    edit(1, 2ms, 1ms);  // within the bound of the client's clock
    EXPECT_EQ(stage("client to master").p50_seconds, 0.0);
    built(1, 0, 0ms, 0ms);
    for (const std::int64_t lie :
         {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()}) {
        log.submitted({.submitted_at = lie, .clock = client, .received = at(0ms), .version = version(1)});
        log.node_built(NodeId{1}, "n", version(1), lie, lie, node_clock);
    }
    for (const session::StageTimes& stage : log.stages()) EXPECT_GE(stage.p50_seconds, 0.0);
}

TEST_F(EditTraceTest, ReportsOfAnotherEpochAreIgnored) {
    edit(5, 0ms, 1ms);
    log.published({Epoch + 1, 7}, at(2ms));
    EXPECT_EQ(log.latest(1)[0].published, 0);
}

}  // namespace

}  // namespace tessera::master
