// Samples where rendered pictures need them.
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/bench/adaptive/adaptive_bench.h"
#include "tests/bench/scenes/scenes.h"

namespace tessera::tools::bench {
namespace {

struct BenchAdaptive : testing::Test {
    std::filesystem::path references =
        std::filesystem::temp_directory_path() / ("tessera-bench-adaptive-" + std::to_string(::getpid()));
    ~BenchAdaptive() override { std::filesystem::remove_all(references); }

    std::optional<AdaptiveScene> measured(const AdaptivePlan& plan, const std::stop_token& stop = {}) const {
        const auto scene = load_scene("grids", "");
        EXPECT_TRUE(scene);
        tbb::task_arena arena(2);
        return measure_adaptive(*scene, plan, arena, SilentProgress, stop);
    }
};

// Shadows of grids need many samples, the floor around them few.
TEST_F(BenchAdaptive, AsManySamplesGiveASmallerErrorWhereTheyAreNeeded) {
    const auto grids = measured({.references = references,
                                 .spp = {32},
                                 .noise = {0.1},
                                 .size = {96, 54},
                                 .seeds = 3,
                                 .reference_spp = 512});
    ASSERT_TRUE(grids);
    ASSERT_EQ(grids->rows.size(), 2u);
    for (const AdaptiveRow& row : grids->rows) {
        std::printf("noise %.2f: %.1f spp, gain %.2f, trimmed %.2f, light %.4f, true noise %.2f to %.2f\n",
                    row.noise, row.spp, row.gain, row.trimmed_gain, row.light, row.true_noise.front(),
                    row.true_noise.back());
        EXPECT_GT(row.gain, 1.4);
        EXPECT_GT(row.trimmed_gain, 1.4);
        EXPECT_NEAR(row.light, 1.0, 0.005);
        EXPECT_GT(row.true_noise.front(), 0.5);
        EXPECT_LT(row.true_noise.back(), 1.2);
        EXPECT_GT(row.steps, 1.0);
    }
    EXPECT_GT(grids->rows[0].spp, 26.0);
    EXPECT_LE(grids->rows[0].spp, 32.0);
    EXPECT_GT(grids->masked_rate, 0.0);
}

TEST_F(BenchAdaptive, StopsOnRequest) {
    std::stop_source stop;
    stop.request_stop();
    EXPECT_FALSE(
        measured({.references = references, .spp = {32}, .size = {32, 32}, .seeds = 1, .reference_spp = 4},
                 stop.get_token()));
}

}  // namespace
}  // namespace tessera::tools::bench
