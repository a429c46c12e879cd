#include "mediator/net/liveness.h"

#include <gtest/gtest.h>

namespace tessera::net {

namespace {

using namespace std::chrono_literals;

const LivenessSettings Settings{.interval = 1s, .missed = 3, .min_backoff = 100ms, .max_backoff = 5s};

TimePoint at(Duration since_start) {
    return TimePoint{1000s} + since_start;
}

TEST(Liveness, AHeartbeatIsDueAtOnceAndThenEveryInterval) {
    Liveness liveness(Settings, at(0s));
    EXPECT_TRUE(liveness.heartbeat_due(at(0s)));
    liveness.sent_heartbeat(at(0s));
    EXPECT_FALSE(liveness.heartbeat_due(at(999ms)));
    EXPECT_TRUE(liveness.heartbeat_due(at(1s)));
    liveness.sent_heartbeat(at(1500ms));
    EXPECT_FALSE(liveness.heartbeat_due(at(2s)));
    EXPECT_TRUE(liveness.heartbeat_due(at(2500ms)));
}

TEST(Liveness, TimesOutAfterAllMissedIntervals) {
    struct Case {
        std::vector<Duration> heard;
        Duration now;
        bool timed_out;
    };
    const std::vector<Case> cases{
        {{}, 2999ms, false},
        {{}, 3s, true},
        {{2s}, 4999ms, false},
        {{2s}, 5s, true},
        {{2s, 4900ms}, 7s, false},
        {{2900ms}, 3s, false},
        {{4s, 1s}, 6999ms, false},  // an earlier time
                                    // does not replace
                                    // a later one
        {{4s, 1s}, 7s, true},
    };
    for (const Case& one : cases) {
        Liveness liveness(Settings, at(0s));
        for (const Duration heard : one.heard) liveness.on_message(at(heard));
        EXPECT_EQ(liveness.timed_out(at(one.now)), one.timed_out) << one.now.count();
    }
}

// A loop that sleeps until next_event() must find something to do then, or it spins.
TEST(Liveness, SilenceDoesNotCountWhileThisProcessDidNotListen) {
    const LivenessSettings settings{.interval = std::chrono::seconds(1), .missed = 3};
    const TimePoint start{std::chrono::hours(1)};
    Liveness liveness(settings, start);
    const TimePoint later = start + std::chrono::seconds(10);
    for (int i = 0; i < 4; ++i) liveness.was_deaf(std::chrono::seconds(2), later);
    EXPECT_FALSE(liveness.timed_out(later)) << "2 s of silence";
    EXPECT_TRUE(liveness.timed_out(later + std::chrono::seconds(1)));
    liveness.was_deaf(std::chrono::hours(1), later);
    EXPECT_FALSE(liveness.timed_out(later + settings.max_backoff)) << "the peer may be in its back-off";
    EXPECT_TRUE(liveness.timed_out(later + settings.max_backoff + std::chrono::seconds(3)));
}

TEST(Liveness, NextEventIsTheFirstTimeThatSomethingIsDue) {
    Liveness liveness(Settings, at(0s));
    liveness.sent_heartbeat(at(0s));
    TimePoint now = at(0s);
    for (int i = 0; i < 20 && !liveness.timed_out(now); ++i) {
        const TimePoint next = liveness.next_event();
        ASSERT_GT(next, now);
        EXPECT_FALSE(liveness.heartbeat_due(next - 1ns) || liveness.timed_out(next - 1ns));
        ASSERT_TRUE(liveness.heartbeat_due(next) || liveness.timed_out(next));
        now = next;
        liveness.sent_heartbeat(now);
    }
    EXPECT_EQ(now, at(3s));
}

TEST(Liveness, BackoffDoublesUpToItsMaximumAndResetsOnAMessage) {
    Liveness liveness(Settings, at(0s));
    const std::vector<Duration> expected{100ms, 200ms, 400ms, 800ms, 1600ms, 3200ms, 5s, 5s};
    for (const Duration backoff : expected) EXPECT_EQ(liveness.next_backoff(), backoff);
    liveness.on_message(at(60s));
    EXPECT_EQ(liveness.next_backoff(), 100ms);
}

TEST(Liveness, ARestartResetsTheTimeoutButKeepsTheBackoff) {
    Liveness liveness(Settings, at(0s));
    ASSERT_TRUE(liveness.timed_out(at(10s)));
    liveness.next_backoff();
    liveness.restarted(at(10s));
    EXPECT_FALSE(liveness.timed_out(at(12s)));
    EXPECT_TRUE(liveness.timed_out(at(13s)));
    EXPECT_EQ(liveness.next_backoff(), 200ms);
}

TEST(Liveness, HundredsOfYearsOfBackoffDoNotOverflow) {
    Liveness liveness({.max_backoff = 5s}, at(0s));
    for (int i = 0; i < 10000; ++i) {
        const Duration backoff = liveness.next_backoff();
        ASSERT_GT(backoff, 0s);
        ASSERT_LE(backoff, 5s);
    }
}

}  // namespace

}  // namespace tessera::net
