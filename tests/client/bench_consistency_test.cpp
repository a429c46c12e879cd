// What `tessera bench consistency` measures, and that it can tell.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "master/filter/catalog.h"
#include "mediator/base/random.h"
#include "tests/bench/consistency/consistency_bench.h"
#include "tests/bench/consistency/rare_light.h"
#include "tests/bench/filters/looks.h"

namespace tessera::tools::bench {
namespace {

ConsistencyPlan plan(const std::filesystem::path& folder, std::initializer_list<const char*> filters) {
    ConsistencyPlan plan{
        .references = folder, .spp = {4, 16}, .reference_spp = 256, .size = {48, 27}, .seeds = 2};
    for (const char* text : filters) plan.filters.push_back(*filter::parse_choice(text, filter::catalog()));
    return plan;
}

TEST(BenchConsistency, FindsThatABlurKeepsNoPromise) {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("tessera-bench-consistency-" + std::to_string(::getpid()));
    const auto scene = load_scene("grids", "");
    ASSERT_TRUE(scene);
    tbb::task_arena arena(2);
    const auto measured =
        measure_consistency(*scene, plan(folder, {"none", "gauss:sigma=6"}), arena, SilentProgress, {});
    ASSERT_TRUE(measured);
    ASSERT_EQ(measured->cells.size(), 4u);
    for (const ConsistencyCell& cell : measured->cells) {
        if (cell.filter == "none") {
            EXPECT_EQ(cell.all.mean, 1.0);
            EXPECT_EQ(cell.trimmed.single, 1.0);
            EXPECT_EQ(cell.energy, 1.0);
        } else if (cell.spp == 16) {
            EXPECT_GT(cell.all.mean, 2.0);
            EXPECT_EQ(cell.all.single, 0.0);
        }
    }
    const auto broken = broken_promises(*measured);
    EXPECT_TRUE(std::ranges::any_of(broken, [](const std::string& line) {
        return line.find("grids, gauss:sigma=6, 16 spp: relMSE is") != std::string::npos;
    }));
    EXPECT_TRUE(std::ranges::none_of(
        broken, [](const std::string& line) { return line.find("none") != std::string::npos; }));
    EXPECT_TRUE(measured->slopes.empty()) << "none has 256 samples";
    std::stop_source stop;
    stop.request_stop();
    EXPECT_FALSE(
        measure_consistency(*scene, plan(folder, {"none"}), arena, SilentProgress, stop.get_token()));
    std::filesystem::remove_all(folder);
}

TEST(BenchConsistency, EveryPromiseHasItsLine) {
    const ConsistencyCell good{
        .filter = "x", .spp = 4, .all = {1.0, 1.0}, .trimmed = {1.0, 1.0}, .energy = 1.0};
    const auto lines = [](ConsistencyCell cell, double slope = 1.0) {
        return broken_promises({.name = "s", .cells = {std::move(cell)}, .slopes = {{"x", slope}}}).size();
    };
    EXPECT_EQ(lines(good), 0u);
    ConsistencyCell cell = good;
    cell.all.mean = 1.03;
    EXPECT_EQ(lines(cell), 1u);
    cell.rare_light = 0.02;
    EXPECT_EQ(lines(cell), 0u) << "nothing can be known about rare light";
    cell.all.mean = 1.16;
    EXPECT_EQ(lines(cell), 1u);
    cell = good;
    cell.trimmed.single = 0.9;
    EXPECT_EQ(lines(cell), 1u);
    cell = good;
    cell.energy = 0.985;
    EXPECT_EQ(lines(cell), 1u);
    EXPECT_EQ(lines(good, 0.9), 1u);
}

// Light of probability p and value 1 / p: 25 n p finds are expected in a window.
TEST(RareLight, IsThatOfWindowsThatExpectFewerThanThreeFinds) {
    constexpr std::int32_t Edge = 40;
    constexpr std::uint32_t Samples = 1u << 20;
    frame::FilmTile film({0, 0, Edge, Edge}, {0, 1}, {frame::Channel::Radiance});
    std::fill(film.counts.begin(), film.counts.end(), Samples);
    const auto put = [&](std::size_t pixel, double probability) {
        for (std::uint32_t c = 0; c < 3; ++c) {
            film.plane(c)[pixel] = 1.0f;
            film.plane(3 + c)[pixel] = static_cast<float>(Samples * (1.0 / probability - 1.0));
        }
    };
    for (std::size_t i = 0; i < film.counts.size(); ++i) put(i, i % Edge < Edge / 2 ? 0.01 : 0.5);
    EXPECT_NEAR(rare_light(film, 1), 0.525, 0.03)
        << "a quarter of a find on the left, 12 on the right; mixed between";
    EXPECT_NEAR(rare_light(film, 8), 0.5, 0.03);
    EXPECT_EQ(rare_light(film, 40), 0.0) << "three in the 9 pixels of a corner, too";
}

frame::Image uniform(float value) {
    frame::Image image(32, 20, 3);
    std::ranges::fill(image.values, value);
    return image;
}

TEST(Looks, SpecksStandOutInThePictureAndNotInTheReference) {
    const frame::Image reference = uniform(1.0f);
    frame::Image picture = reference;
    EXPECT_EQ(speck_fraction(picture, reference), 0.0);
    const std::size_t pixel = 7 * 32 + 9, corner = 0;
    for (const std::size_t i : {pixel, corner}) std::ranges::fill(picture.pixel(i), 1.3f);
    EXPECT_DOUBLE_EQ(speck_fraction(picture, reference), 2.0 / (32 * 20));
    EXPECT_EQ(speck_fraction(picture, picture), 0.0) << "real detail";
    std::ranges::fill(picture.pixel(pixel), 1.2f);
    EXPECT_DOUBLE_EQ(speck_fraction(picture, reference), 1.0 / (32 * 20)) << "less than a quarter";
    std::ranges::fill(picture.pixel(corner), 0.7f);
    EXPECT_DOUBLE_EQ(speck_fraction(picture, reference), 1.0 / (32 * 20)) << "dark ones count, too";
    EXPECT_EQ(speck_fraction(uniform(5.0f), reference), 0.0) << "a wrong brightness is not a speck";
    EXPECT_DOUBLE_EQ(mean_luminance(uniform(0.5f)), 0.5);
}

}  // namespace
}  // namespace tessera::tools::bench
