#include <gtest/gtest.h>

#include "mediator/session/view_request.h"

namespace tessera::master {
namespace {

using namespace std::chrono_literals;

constexpr TimePoint Start{100s};

TEST(StopRule, SampleLimitHasNoDeadline) {
    const session::StopRule rule{.spp = 32};
    EXPECT_FALSE(rule.has_clock());
    EXPECT_EQ(rule.max_samples(), 32u);
    EXPECT_FALSE(rule.deadline(Start, Start, {}));
    EXPECT_FALSE(rule.time_is_up(std::nullopt, true, Start + 1h));
}

TEST(StopRule, ATimeLimitCountsFromNow) {
    const session::StopRule rule{.spp = 0, .time_limit = 3s};
    EXPECT_EQ(rule.max_samples(), session::MaxSamplesPerPixel);
    const auto deadline = rule.deadline(Start, Start + 1s, 2s);
    EXPECT_EQ(deadline, Start + 4s) << "later times have no influence";
    EXPECT_FALSE(rule.time_is_up(deadline, false, Start + 3s));
    EXPECT_TRUE(rule.time_is_up(deadline, false, Start + 4s));
}

TEST(StopRule, ABudgetLeavesTimeForThePicture) {
    const session::StopRule rule{.spp = 16, .budget = 8s};
    EXPECT_EQ(rule.max_samples(), session::MaxSamplesPerPixel);
    const auto deadline = rule.deadline(Start, Start + 1s, 3s);
    EXPECT_EQ(deadline, Start + 5s);
    EXPECT_EQ(rule.deadline(Start, Start + 1s, 20s), Start + 1s) << "at once when there is no time";
    EXPECT_TRUE(rule.time_is_up(deadline, true, Start + 5s));
    EXPECT_FALSE(rule.time_is_up(deadline, false, Start + 5s)) << "a pixel has no sample yet";
    EXPECT_TRUE(rule.time_is_up(deadline, false, Start + 6s)) << "an eighth of the budget later at most";
}

}  // namespace
}  // namespace tessera::master
