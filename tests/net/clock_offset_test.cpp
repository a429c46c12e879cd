#include "mediator/net/clock_offset.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

namespace tessera::net {

namespace {

using namespace std::chrono_literals;

// Two clocks and the network delay between them; the master's clock is exact.
struct Pair {
    std::int64_t now = 1'000'000'000'000;  // of our clock
    std::int64_t offset = 0;               // theirs less ours, at `started`
    double drift = 0;                      // theirs gains that much
    std::int64_t started = 1'000'000'000'000;
    PeerClock clock;

    std::int64_t true_offset() const {
        return offset + static_cast<std::int64_t>(drift * static_cast<double>(now - started));
    }
    std::int64_t theirs() const { return now + true_offset(); }
    void exchange(Duration there, Duration rest, Duration back) {
        ClockExchange e{.sent = now};
        now += there.count();
        e.received_there = theirs();
        now += rest.count();
        e.sent_there = theirs();
        now += back.count();
        e.received = now;
        clock.add(e);
    }
    ClockOffset stated() const { return clock.offset(TimePoint{Duration(now)}).value(); }
    void expect_truth(const char* when) const {
        const ClockOffset at = stated();
        EXPECT_LE(std::abs(at.offset.count() - true_offset()), at.bound.count())
            << when << ": stated " << at.offset.count() << " ns, true " << true_offset() << " ns";
    }
};

TEST(ClockOffset, NothingIsKnownBeforeTheFirstExchange) {
    PeerClock clock;
    EXPECT_FALSE(clock.offset(TimePoint{}).has_value());
    clock.heartbeat(5, 0, 0, TimePoint{10ns});  // echoes nothing
    EXPECT_FALSE(clock.offset(TimePoint{}).has_value());
}

TEST(ClockOffset, RandomDelaysStayWithinTheBound) {
    std::mt19937_64 random(1);
    std::exponential_distribution<double> delay(1.0 / 2e6);  // 2 ms
    std::uniform_int_distribution<std::int64_t> start(-1'000'000'000'000'000, 1'000'000'000'000'000);
    for (int peer = 0; peer < 200; ++peer) {
        Pair pair{.offset = start(random)};
        for (int i = 0; i < 200; ++i) {
            const auto some = [&] { return Duration(static_cast<std::int64_t>(delay(random))); };
            pair.exchange(some(), some(), some());
            pair.expect_truth("after an exchange");
            pair.now += 1'000'000'000;
            pair.expect_truth("a second later");
        }
        EXPECT_EQ(pair.clock.size(), PeerClock::MaxExchanges) << "no jump where there was none";
    }
}

TEST(ClockOffset, TheExchangeWithTheShortestRoundTripIsUsed) {
    Pair pair{.offset = 7'000'000};
    pair.exchange(5ms, 1s, 30us);
    pair.exchange(100us, 1s, 100us);
    pair.exchange(40us, 0s, 9ms);
    const ClockOffset at = pair.stated();
    EXPECT_EQ(at.offset, 7ms);
    // Half of 200 us, and the drift of the 9.04 ms since.
    EXPECT_NEAR(static_cast<double>(at.bound.count()), 100'000 + 100e-6 * 9'040'000, 2.0);
}

TEST(ClockOffset, ARelayThatDelaysOneDirectionStaysWithinTheBound) {
    for (const bool there : {true, false}) {
        Pair pair;
        for (int i = 0; i < 30; ++i) {
            pair.exchange(there ? 20'050us : 50us, 100ms, there ? 50us : 20'050us);
            pair.now += 900'000'000;
        }
        pair.expect_truth("with the relay");
        EXPECT_NEAR(seconds(pair.stated().offset), there ? 0.01 : -0.01, 1e-4);
        EXPECT_GE(pair.stated().bound, 10ms);
    }
}

TEST(ClockOffset, DriftIsPartOfTheBound) {
    for (const double drift : {-100e-6, -50e-6, 50e-6, 100e-6}) {
        Pair pair{.offset = -3'000'000'000, .drift = drift};
        pair.exchange(10us, 0s, 10us);  // the best for a minute
        for (int i = 0; i < 300; ++i) {
            pair.now += 1'000'000'000;
            pair.exchange(1ms, 0s, 400us);
            pair.expect_truth("while it drifts");
        }
        EXPECT_EQ(pair.clock.size(), PeerClock::MaxExchanges) << "drift is no jump";
    }
}

TEST(ClockOffset, AJumpDropsWhatWasBefore) {
    for (const std::int64_t jump :
         std::vector<std::int64_t>{-3'600'000'000'000, -50'000'000, 50'000'000, 3'600'000'000'000}) {
        Pair pair{.offset = 1'000'000};
        for (int i = 0; i < 20; ++i) {
            pair.exchange(10us, 0s, 10us);
            pair.now += 1'000'000'000;
        }
        pair.offset += jump;
        pair.exchange(2ms, 0s, 3ms);  // a poor one, but the only one that is true
        pair.expect_truth("after the jump");
        EXPECT_EQ(pair.clock.size(), 1u);
    }
}

TEST(ClockOffset, AJumpDuringAnExchangeIsHandled) {
    for (const std::int64_t jump : std::vector<std::int64_t>{-80'000'000, 80'000'000}) {
        Pair pair;
        pair.exchange(100us, 0s, 100us);
        ClockExchange e{.sent = pair.now, .received_there = pair.theirs()};
        pair.offset += jump;
        pair.now += 1'000'000;
        e.sent_there = pair.theirs();
        e.received = pair.now;
        pair.clock.add(e);
        pair.now += 1'000'000'000;
        pair.exchange(100us, 0s, 100us);
        pair.expect_truth("after it");
    }
}

TEST(ClockOffset, OneWrongExchangeIsDroppedWithTheNextValidOne) {
    Pair pair;
    pair.exchange(100us, 0s, 100us);
    pair.clock.add({.sent = pair.now, .received_there = 5, .sent_there = 6, .received = pair.now + 2});
    pair.exchange(100us, 0s, 100us);
    pair.expect_truth("after the wrong exchange");
}

TEST(ClockOffset, ImpossibleTimesAreIgnoredAndHugeOnesDoNotOverflow) {
    constexpr std::int64_t Most = std::numeric_limits<std::int64_t>::max();
    constexpr std::int64_t Least = std::numeric_limits<std::int64_t>::min();
    Pair pair;
    pair.exchange(100us, 0s, 100us);
    const ClockOffset before = pair.stated();
    for (const std::int64_t a : {Most, Least, Most / 2, Least / 2}) {
        pair.clock.add({a, 0, 0, pair.now});
        pair.clock.add({0, a, 0, pair.now});
        pair.clock.add({0, 0, a, pair.now});
        pair.clock.add({0, 0, 0, a});
        for (const std::int64_t b : {Most, Least, std::int64_t{0}}) {
            pair.clock.heartbeat(a, b, b, TimePoint{Duration(pair.now)});
            pair.clock.heartbeat(b, 1, a, TimePoint{Duration(a)});
        }
    }
    pair.clock.add({.sent = 10, .received_there = 5, .sent_there = 5, .received = 9});  // back before sent
    pair.clock.add(
        {.sent = 10, .received_there = 6, .sent_there = 5, .received = 12});  // answered before received
    pair.clock.add({.sent = 10,
                    .received_there = 5,
                    .sent_there = 9,
                    .received = 12});  // delayed longer at the peer than the round trip
    EXPECT_EQ(pair.clock.size(), 1u);
    EXPECT_EQ(pair.stated().offset, before.offset);
    EXPECT_TRUE(pair.clock.offset(TimePoint{Duration(Most)}).has_value());
    EXPECT_TRUE(pair.clock.offset(TimePoint{Duration(Least)}).has_value());
    EXPECT_EQ(to_our_clock(Most, {.offset = -5ns}), Most);
    EXPECT_EQ(to_our_clock(Least, {.offset = 5ns}), Least);
    EXPECT_EQ(to_our_clock(100, {.offset = 30ns}), 70);
}

TEST(ClockOffset, AHeartbeatHoldsAllFourTimes) {
    // Sent at 1000, there at 5100 (their clock is 4000 ahead, 100 in transit), answered 50 later, back at
    // 1250.
    PeerClock clock;
    clock.heartbeat(5150, 1000, 50, TimePoint{1250ns});
    const auto at = clock.offset(TimePoint{1250ns});
    ASSERT_TRUE(at);
    EXPECT_EQ(at->offset, 4000ns);
    EXPECT_NEAR(static_cast<double>(at->bound.count()), 100.0, 1.0);
}

}  // namespace

}  // namespace tessera::net
