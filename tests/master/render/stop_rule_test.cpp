#include <gtest/gtest.h>

#include "mediator/session/view_request.h"

namespace tessera::master {
namespace {

using namespace std::chrono_literals;

constexpr TimePoint Start{100s};

TEST(StopRule, SampleLimitHasNoDeadline) {
    const session::StopRule rule{.spp = 32};
    EXPECT_FALSE(rule.has_clock());
    EXPECT_FALSE(rule.has_steps());
    EXPECT_FALSE(rule.deadline(Start, Start, {}));
    EXPECT_FALSE(rule.time_is_up(std::nullopt, true, Start + 1h));
}

TEST(StopRule, ATimeLimitCountsFromNow) {
    const session::StopRule rule{.time_limit = 3s};
    const auto deadline = rule.deadline(Start, Start + 1s, 2s);
    EXPECT_EQ(deadline, Start + 4s) << "later times have no influence";
    EXPECT_FALSE(rule.time_is_up(deadline, false, Start + 3s));
    EXPECT_TRUE(rule.time_is_up(deadline, false, Start + 4s));
}

TEST(StopRule, ABudgetLeavesTimeForThePicture) {
    const session::StopRule rule{.budget = 8s};
    const auto deadline = rule.deadline(Start, Start + 1s, 3s);
    EXPECT_EQ(deadline, Start + 5s);
    EXPECT_EQ(rule.deadline(Start, Start + 1s, 20s), Start + 1s) << "at once when there is no time";
    EXPECT_TRUE(rule.time_is_up(deadline, true, Start + 5s));
    EXPECT_FALSE(rule.time_is_up(deadline, false, Start + 5s)) << "a pixel has no sample yet";
    EXPECT_TRUE(rule.time_is_up(deadline, false, Start + 6s)) << "an eighth of the budget later at most";
}

TEST(StopRule, StepsFollowWhereNoiseOrTimeEndThePicture) {
    using session::StopRule;
    EXPECT_TRUE((StopRule{.noise = 0.1}.has_steps()));
    EXPECT_TRUE((StopRule{.noise = 0.1, .uniform = true}.has_steps())) << "to see whether it is reached";
    EXPECT_TRUE((StopRule{.time_limit = 1s}.has_steps()));
    EXPECT_TRUE((StopRule{.budget = 1s}.has_steps()));
    EXPECT_FALSE((StopRule{.time_limit = 1s, .uniform = true}.has_steps()));
    EXPECT_FALSE((StopRule{.spp = 16, .time_limit = 1s, .noise = 0.1}.has_steps()))
        << "nothing is left to decide";
}

}  // namespace
}  // namespace tessera::master
