// Time budgets: the time reserved for filter and encoding, and the possible picture size.
#include "master/render/time_budget.h"

#include <gtest/gtest.h>

namespace tessera::master {
namespace {

TEST(TimeBudget, HasNoPredictionBeforeTheFirstMeasurement) {
    TimeBudget budget;
    EXPECT_FALSE(budget.predict("fdf", 1000));
    budget.measured("fdf", 0, 1.0);
    EXPECT_FALSE(budget.predict("fdf", 1000)) << "a picture without pixels gives no measurement";
    budget.measured("fdf", 1000, 0.5);
    EXPECT_FALSE(budget.predict("pixel", 1000));
}

TEST(TimeBudget, ScalesWithThePixels) {
    TimeBudget budget;
    budget.measured("fdf", 160'000, 0.04);
    EXPECT_DOUBLE_EQ(*budget.predict("fdf", 160'000), 0.04);
    EXPECT_DOUBLE_EQ(*budget.predict("fdf", 640'000), 0.16);
}

TEST(TimeBudget, PredictsTheSlowestOfTheLatestFew) {
    TimeBudget budget;
    budget.measured("fdf", 1000, 0.9);
    for (int i = 0; i < 7; ++i) budget.measured("fdf", 1000, 0.1);
    EXPECT_DOUBLE_EQ(*budget.predict("fdf", 1000), 0.9);
    budget.measured("fdf", 1000, 0.2);
    EXPECT_DOUBLE_EQ(*budget.predict("fdf", 1000), 0.2) << "one slow picture is forgotten in the end";
}

TEST(TimeBudget, RemembersABoundedNumberOfCostKeys) {
    TimeBudget budget;
    for (int i = 0; i < 10'000; ++i) budget.measured("way " + std::to_string(i), 10, 1.0);
    int known = 0;
    for (int i = 0; i < 10'000; ++i) known += budget.predict("way " + std::to_string(i), 10) ? 1 : 0;
    EXPECT_GT(known, 0);
    EXPECT_LE(known, 256);
}

TEST(TimeBudget, ChoosesTheLargestSizeThatFits) {
    EXPECT_EQ(scale_that_fits(1'000'000, 1.0, 2e6, 2.0), 1u);
    EXPECT_EQ(scale_that_fits(1'000'000, 1.0, 1.99e6, 2.0), 2u);
    EXPECT_EQ(scale_that_fits(1'000'000, 1.0, 0.5e6, 2.0), 2u);
    EXPECT_EQ(scale_that_fits(1'000'000, 1.0, 0.49e6, 2.0), 4u);
    EXPECT_EQ(scale_that_fits(1'000'000, 0.0, 1e6, 2.0), 4u);
    EXPECT_EQ(scale_that_fits(1'000'000, -1.0, 1e6, 2.0), 4u);
    EXPECT_EQ(scale_that_fits(1'000'000, 1.0, 0.0, 2.0), 1u) << "an unknown rate changes nothing";
}

}  // namespace
}  // namespace tessera::master
