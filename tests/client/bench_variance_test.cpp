// Estimated against true variances of rendered pictures.
#include <gtest/gtest.h>

#include "tests/bench/scenes/scenes.h"
#include "tests/bench/variance/variance_bench.h"

namespace tessera::tools::bench {
namespace {

VarianceScene measured(const std::string& name, std::uint32_t seeds) {
    const auto scene = load_scene(name, "");
    EXPECT_TRUE(scene);
    tbb::task_arena arena(2);
    const VariancePlan plan{.spp = {4, 16, 64}, .size = {64, 32}, .seeds = seeds};
    return *measure_variances(*scene, plan, arena, SilentProgress, {});
}

// Direct light is stratified: as if samples were independent, its error is overestimated ever more.
TEST(BenchVariance, SoftShadowsHaveSmallerErrorsThanIndependentSamples) {
    const VarianceScene grids = measured("grids", 16);
    ASSERT_EQ(grids.rows.size(), 3u);
    for (const VarianceRow& row : grids.rows) {
        std::printf("%d spp: %u blocks, %.2f within, picture %.2f, independent %.2f\n", int(row.spp),
                    row.blocks, row.within, row.whole, row.independent);
        EXPECT_GT(row.blocks, 4u) << row.spp;
        EXPECT_GT(row.whole, 0.8) << row.spp;
        EXPECT_LT(row.whole, 1.6) << row.spp;
        EXPECT_GT(row.within, 0.75) << row.spp;
        // At 4 samples most of the effect is within what chance explains, so little of it counts.
        EXPECT_GT(row.independent, (row.spp == 4 ? 1.1 : 1.2) * row.whole) << row.spp;
    }
    EXPECT_GT(grids.rows[2].independent, 1.2 * grids.rows[0].independent);
}

// A lamp that is seen has a sharp edge, which is nothing but stratified.
TEST(BenchVariance, TheEdgeOfALampHasASmallerErrorThanIndependentSamples) {
    const VarianceScene cornell = measured("cornell", 12);
    for (const VarianceRow& row : cornell.rows) {
        EXPECT_GT(row.whole, 0.6) << row.spp;
        if (row.spp >= 16) {
            EXPECT_LT(row.whole, 0.75 * row.independent) << row.spp;
        }
        EXPECT_GT(row.rare_blocks, 0u) << row.spp << ": light of corners is rare";
    }
}

TEST(BenchVariance, StopsOnRequest) {
    const auto scene = load_scene("grids", "");
    tbb::task_arena arena(2);
    std::stop_source stop;
    stop.request_stop();
    const VariancePlan plan{.spp = {4}, .size = {32, 32}, .seeds = 4};
    EXPECT_FALSE(measure_variances(*scene, plan, arena, SilentProgress, stop.get_token()));
}

}  // namespace
}  // namespace tessera::tools::bench
