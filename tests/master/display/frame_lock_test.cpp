#include "master/display/frame_lock.h"

#include <gtest/gtest.h>

#include <random>

namespace tessera::master {
namespace {

using namespace std::chrono_literals;
using session::OutputState;
using Recipients = FrameLock::Recipients;

struct Locked : testing::Test {
    TimePoint now{1h};
    FrameLock lock{LockSettings{}, 3, 10ms};
    std::uint64_t frame = 0;

    void SetUp() override {
        for (std::size_t i = 0; i < 3; ++i) lock.joined(i);
        (void)begin();
        for (std::size_t i = 0; i < 3; ++i)
            last = lock.ready(i, frame, now);  // now the lock knows how long they take
    }
    std::vector<std::size_t> begin() { return lock.begin(++frame, Recipients::All, now); }
    std::optional<FrameLock::Present> last;
};

TEST_F(Locked, PresentsWhenTheLastOneIsReady) {
    EXPECT_EQ(begin(), (std::vector<std::size_t>{0, 1, 2}));
    EXPECT_FALSE(lock.free());
    EXPECT_FALSE(lock.ready(1, frame, now));
    EXPECT_FALSE(lock.ready(1, frame, now)) << "said twice";
    EXPECT_FALSE(lock.ready(0, frame - 1, now)) << "of an older frame";
    EXPECT_FALSE(lock.ready(0, frame, now));
    const auto present = lock.ready(2, frame, now);
    ASSERT_TRUE(present);
    EXPECT_EQ(present->frame, frame);
    EXPECT_EQ(present->outputs, (std::vector<std::size_t>{0, 1, 2}));
    EXPECT_GT(present->at, now);
    EXPECT_TRUE(lock.free());
}

TEST_F(Locked, PresentTimeAllowsForTheSlowestConnection) {
    lock.clock_bound(1, 20ms);
    (void)begin();
    std::optional<FrameLock::Present> present;
    for (std::size_t i = 0; i < 3; ++i) present = lock.ready(i, frame, now);
    EXPECT_GE(present->at - now, 40ms) << "the round trip is twice the bound";
    const TimePoint before = present->at;
    (void)begin();
    lock.clock_bound(1, 0ms);
    for (std::size_t i = 0; i < 3; ++i) present = lock.ready(i, frame, now);
    EXPECT_GE(present->at - before, 10ms) << "not faster than the display's rate";
}

TEST_F(Locked, LateOutputIsDroppedOnceAndRejoins) {
    (void)begin();
    (void)lock.ready(0, frame, now);
    (void)lock.ready(2, frame, now);
    EXPECT_FALSE(lock.tick(now + 99ms));
    now += 100ms;
    const auto present = lock.tick(now);
    ASSERT_TRUE(present);
    EXPECT_EQ(present->outputs, (std::vector<std::size_t>{0, 2}));
    EXPECT_EQ(lock.outputs()[1].state, OutputState::Late);
    const std::uint64_t missed = frame;
    EXPECT_EQ(begin(), (std::vector<std::size_t>{0, 2})) << "it is not waited for any more";
    (void)lock.ready(0, frame, now);
    EXPECT_FALSE(lock.ready(1, missed, now)) << "it is back, but not in this frame";
    EXPECT_EQ(lock.outputs()[1].state, OutputState::Joining);
    EXPECT_TRUE(lock.ready(2, frame, now));
    EXPECT_EQ(begin(), (std::vector<std::size_t>{0, 1, 2}));
    EXPECT_EQ(lock.outputs()[1].late, 1u);
}

TEST_F(Locked, PatienceAdaptsToLargePictures) {
    (void)begin();
    for (std::size_t i = 0; i < 3; ++i) {
        now += 400ms;
        EXPECT_FALSE(lock.tick(now - 350ms));
        (void)lock.ready(i, frame, now);
    }
    (void)begin();
    (void)lock.ready(0, frame, now);
    EXPECT_FALSE(lock.tick(now + 799ms)) << "twice the longest pause of the frame before";
    EXPECT_TRUE(lock.tick(now + 800ms));
}

// An output that needs longer than the timeout is not dropped for ever.
TEST_F(Locked, ConstantlySlowOutputIsEventuallyWaitedFor) {
    std::uint64_t dropped = 0;
    for (int i = 0; i < 20; ++i) {
        (void)begin();
        const std::uint64_t sent = frame;
        (void)lock.ready(0, sent, now);
        (void)lock.ready(2, sent, now);
        now += 150ms;  // what output 1 needs
        if (lock.tick(now)) {
            ++dropped;
        }
        (void)lock.ready(1, sent, now);
        EXPECT_TRUE(lock.free());
    }
    EXPECT_EQ(dropped, 1u);
    EXPECT_EQ(lock.outputs()[1].state, OutputState::Locked);
}

TEST_F(Locked, LongPauseOfOneOutputDoesNotDelayOthersAsLong) {
    (void)begin();
    const std::uint64_t sent = frame;
    (void)lock.ready(0, sent, now);
    (void)lock.ready(2, sent, now);
    ASSERT_TRUE(lock.tick(now + 100ms));
    now += 60s;
    (void)lock.ready(1, sent, now);
    (void)begin();
    (void)lock.ready(0, frame, now);
    (void)lock.ready(2, frame, now);
    EXPECT_TRUE(lock.tick(now + 2s));
}

TEST_F(Locked, DisconnectedOutputIsNotWaitedFor) {
    (void)begin();
    (void)lock.ready(0, frame, now);
    (void)lock.ready(1, frame, now);
    EXPECT_TRUE(lock.left(2, now));
    EXPECT_EQ(lock.outputs()[2].state, OutputState::Absent);
    EXPECT_EQ(begin().size(), 2u);
    EXPECT_FALSE(lock.left(0, now));
    EXPECT_FALSE(lock.left(1, now)) << "no output is left to present";
    EXPECT_TRUE(lock.free());
    EXPECT_TRUE(begin().empty());
    EXPECT_TRUE(lock.free()) << "no outputs";
}

TEST_F(Locked, JoiningOutputIsSentTheCurrentFrame) {
    (void)lock.left(2, now);
    lock.joined(2);
    EXPECT_TRUE(lock.has_joining());
    EXPECT_EQ(lock.begin(frame, Recipients::Joining, now), std::vector<std::size_t>{2});
    const std::uint64_t before = lock.frames();
    const auto present = lock.ready(2, frame, now);
    ASSERT_TRUE(present);
    EXPECT_EQ(present->frame, frame);
    EXPECT_EQ(lock.frames(), before) << "no new frame";
    EXPECT_FALSE(lock.has_joining());
}

// In any sequence of events an output has at most one frame in flight, and the lock never waits for ever.
TEST(FrameLockFuzz, NeverStallsAndNeverSendsTwo) {
    std::mt19937 random(7);
    for (int run = 0; run < 200; ++run) {
        TimePoint now{1h};
        FrameLock lock({}, 4, 1ms);
        std::array<std::uint64_t, 4> in_flight{};
        std::uint64_t frame = 0, presented = 0;
        TimePoint free_since = now;
        for (int step = 0; step < 500; ++step) {
            now += std::chrono::milliseconds(random() % 60);
            const std::size_t who = random() % 4;
            std::optional<FrameLock::Present> present;
            switch (random() % 8) {
                case 0:
                    lock.joined(who);
                    in_flight[who] = 0;
                    break;
                case 1:
                    present = lock.left(who, now);
                    in_flight[who] = 0;
                    break;
                case 2:
                case 3:
                case 4:
                    present = lock.ready(who, in_flight[who], now);
                    in_flight[who] = 0;
                    break;
                default:
                    present = lock.tick(now);
            }
            if (present) {
                EXPECT_GT(present->frame, presented);
                presented = present->frame;
                for (const std::size_t output : present->outputs) EXPECT_EQ(in_flight[output], 0u);
            }
            if (lock.free()) {
                free_since = now;
                for (const std::size_t output : lock.begin(++frame, Recipients::All, now)) {
                    EXPECT_EQ(in_flight[output], 0u);
                    in_flight[output] = frame;
                }
            }
            (void)lock.tick(now);
            EXPECT_LT(now - free_since, 15s);
        }
    }
}

}  // namespace
}  // namespace tessera::master
