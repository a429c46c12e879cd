// Threads inherit the floating-point mode of the thread that starts them; samples, films and filters must not.
#include "tests/numerics/float_mode.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>

#include "mediator/base/bands.h"
#include "mediator/base/float_mode.h"
#include "mediator/base/parallel.h"
#include "mediator/base/task_thread.h"

namespace tessera {
namespace {

using test::has_standard_float_mode, test::UnusualFloatMode;

TEST(FloatMode, IsThatOfTheCallerAgainAfterwards) {
    ASSERT_TRUE(has_standard_float_mode());
    {
        const UnusualFloatMode unusual;
        EXPECT_FALSE(has_standard_float_mode());
        {
            const StandardFloatMode standard;
            EXPECT_TRUE(has_standard_float_mode());
        }
        EXPECT_FALSE(has_standard_float_mode());
    }
    EXPECT_TRUE(has_standard_float_mode());
}

TEST(FloatMode, IsStandardInParallelLoops) {
    constexpr std::size_t Threads = 4;
    const UnusualFloatMode unusual;
    tbb::task_arena arena(Threads);
    std::atomic<int> standard = 0;
    const auto look = [&] { standard += has_standard_float_mode() ? 1 : 0; };
    parallel_for(arena, 1000, [&](std::size_t) { look(); });
    EXPECT_EQ(standard, 1000);
    standard = 0;
    for_bands(&arena, 1000, 10, [&](std::size_t, std::size_t) { look(); });
    EXPECT_EQ(standard, 100);
    standard = 0;
    for_bands(nullptr, 1000, 10, [&](std::size_t, std::size_t) { look(); });
    EXPECT_EQ(standard, 100);
    EXPECT_FALSE(has_standard_float_mode()) << "the caller's mode is its own";
}

TEST(FloatMode, IsStandardInThreadsOfTasks) {
    const UnusualFloatMode unusual;
    std::promise<bool> found;
    TaskThread thread;
    thread.post([&] { found.set_value(has_standard_float_mode()); });
    EXPECT_TRUE(found.get_future().get());
}

}  // namespace
}  // namespace tessera
