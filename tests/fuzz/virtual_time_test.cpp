#include "tests/fuzz/virtual_time.h"

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "tests/support/cpu_time.h"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;

struct VirtualTime : testing::Test {
    VirtualTime() { begin_virtual_time(); }
};

TEST_F(VirtualTime, PassesAtOnceWhenAllThreadsSleep) {
    const auto real = std::chrono::system_clock::now();
    const auto begin = steady_clock::now();
    std::this_thread::sleep_for(10h);
    EXPECT_GE(steady_clock::now() - begin, 10h);
    std::mutex mutex;
    std::condition_variable_any changed;
    std::unique_lock lock(mutex);
    EXPECT_FALSE(changed.wait_for(lock, std::stop_token(), 10h, [] { return false; }));
    EXPECT_GE(virtual_time(), 20h);
    EXPECT_LT(std::chrono::system_clock::now() - real, 1h);
}

TEST_F(VirtualTime, StandsStillWhileAThreadRuns) {
    std::mutex mutex;
    std::condition_variable changed;
    bool is_done = false;
    std::unique_lock lock(mutex);
    const auto begin = steady_clock::now();
    const std::jthread busy([&] {
        while (thread_cpu_seconds() < 0.2) {
        }
        const std::scoped_lock done(mutex);
        is_done = true;
        changed.notify_one();
    });
    EXPECT_TRUE(changed.wait_for(lock, 1ms, [&] { return is_done; })) << "it has timed out";
    EXPECT_LT(steady_clock::now() - begin, 1ms);
}

TEST_F(VirtualTime, WakesThreadsInTheOrderOfTheirTimes) {
    std::mutex mutex;
    std::vector<int> woken;
    {
        std::vector<std::jthread> threads;
        for (const int time : {30, 10, 20, 50, 40}) {
            threads.emplace_back([&, time] {
                std::this_thread::sleep_for(std::chrono::seconds(time));
                const std::scoped_lock lock(mutex);
                woken.push_back(time);
            });
        }
    }
    EXPECT_EQ(woken, (std::vector{10, 20, 30, 40, 50}));
}

// Hundreds of times two threads hand something to and fro, and each time one of them waits for longer than the other
// could sleep.
TEST_F(VirtualTime, LosesNoWakeUp) {
    std::mutex mutex;
    std::condition_variable changed;
    int turn = 0;
    constexpr int Turns = 2000;
    const auto play = [&](int self) {
        std::unique_lock lock(mutex);
        while (turn < Turns) {
            if (!changed.wait_for(lock, 1h, [&] { return turn % 2 == self || turn >= Turns; })) return false;
            if (turn % 3 == 0) {
                lock.unlock();
                std::this_thread::sleep_for(1us);
                lock.lock();
            }
            ++turn;
            changed.notify_all();
        }
        return true;
    };
    bool other = false;
    std::thread thread([&] { other = play(1); });
    EXPECT_TRUE(play(0));
    thread.join();
    EXPECT_TRUE(other);
}

}  // namespace
}  // namespace tessera::test
