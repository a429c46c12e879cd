// Error over samples and time: what the page is made of.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/bench/scenes/scenes.h"
#include "tests/bench/transport/transport_bench.h"
#include "tests/bench/transport/transport_report.h"

namespace tessera::tools::bench {
namespace {

struct References {
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("tessera-bench-transport-" + std::to_string(::getpid()));
    ~References() { std::filesystem::remove_all(path); }
};

// relMSE of `error` at one sample, falling with the power `slope`; `seconds` for each sample.
TransportCurve curve(const std::string& renderer, double error, double falls, double seconds) {
    TransportCurve result{.renderer = renderer, .points = {}, .samples = {}};
    for (const std::uint64_t spp : {1, 2, 4, 8, 16}) {
        TransportPoint point{.spp = spp, .seconds = seconds * double(spp)};
        point.relmse.value = error * std::pow(double(spp), falls);
        result.points.push_back(point);
    }
    return result;
}

TEST(BenchTransport, MeasuresHowFastTheErrorFalls) {
    EXPECT_NEAR(slope(curve("a", 0.3, -1.25, 1.0), 1), -1.25, 1e-12);
    EXPECT_NEAR(slope(curve("a", 0.3, -1.25, 1.0), 4), -1.25, 1e-12);
    EXPECT_EQ(slope(curve("a", 0.3, -1.25, 1.0), 16), 0.0) << "one point";
    TransportCurve late = curve("a", 0.3, -1.0, 1.0);
    late.points[0].relmse.value = 100.0;
    late.points[4].relmse.value = -1e-9;  // below what the references resolve
    EXPECT_NEAR(slope(late, 2), -1.0, 1e-12);
}

TEST(BenchTransport, ComparesTimesToEqualError) {
    const TransportCurve ours = curve("embree", 0.2, -1.0, 0.5), theirs = curve("cycles", 0.4, -1.0, 1.0);
    EXPECT_NEAR(time_to_equal_error(ours, theirs), 0.25, 1e-12);
    EXPECT_EQ(time_to_equal_error(ours, {.renderer = "cycles", .points = {}, .samples = {}}), 0.0);
    const std::vector<TransportScene> scenes{
        {.name = "a", .kind = "", .summary = "", .curves = {ours, theirs}},
        {.name = "b", .kind = "", .summary = "", .curves = {curve("embree", 0.4, -1.0, 1.0), theirs}},
        {.name = "without cycles", .kind = "", .summary = "", .curves = {ours}}};
    EXPECT_NEAR(mean_time_to_equal_error(scenes, "embree"), 0.5, 1e-12);
    EXPECT_EQ(mean_time_to_equal_error(scenes, "vulkan"), 0.0);
}

TEST(BenchTransport, HistogramsAreByPowersOfTwo) {
    LuminanceHistogram samples;
    for (const double luminance : {1.0, 1.999, 2.0, 0.5, 0.0, -1.0, std::nan("")}) samples.add(luminance);
    const auto bin = [&](int exponent) {
        return samples.bins()[static_cast<std::size_t>(exponent - LuminanceHistogram::First)];
    };
    EXPECT_EQ(bin(0), 2u);
    EXPECT_EQ(bin(1), 1u);
    EXPECT_EQ(bin(-1), 1u);
    EXPECT_EQ(samples.black(), 3u);
    EXPECT_EQ(samples.samples(), 7u);
    // What is beyond the bins is in the outermost ones.
    for (const double luminance : {1e-40, 5e-324, 1e30, HUGE_VAL}) samples.add(luminance);
    EXPECT_EQ(samples.bins().front(), 2u);
    EXPECT_EQ(samples.bins().back(), 2u);
}

TEST(BenchTransport, HistogramsMergeInAnyOrder) {
    std::array<LuminanceHistogram, 3> parts;
    LuminanceHistogram all;
    for (int i = 0; i < 300; ++i) {
        const double luminance = std::exp(0.1 * (i % 71) - 3.0);
        parts[static_cast<std::size_t>(i % 3)].add(luminance);
        all.add(luminance);
    }
    LuminanceHistogram forwards, backwards;
    for (std::size_t i = 0; i < 3; ++i) {
        forwards.merge(parts[i]);
        backwards.merge(parts[2 - i]);
    }
    EXPECT_EQ(forwards.bins(), all.bins());
    EXPECT_EQ(backwards.bins(), all.bins());
}

TEST(BenchTransport, FindsTheLightOfRareSamples) {
    LuminanceHistogram samples;
    EXPECT_EQ(samples.light_in_brightest(0.5), 0.0) << "no light";
    for (int i = 0; i < 999; ++i) samples.add(1.0);
    samples.add(1024.0);
    EXPECT_NEAR(samples.light_in_brightest(1e-3), 1024.0 / (1024.0 + 999.0), 1e-12);
    EXPECT_NEAR(samples.light_in_brightest(5e-4), 512.0 / (1024.0 + 999.0), 1e-12);
    EXPECT_NEAR(samples.light_in_brightest(1.0), 1.0, 1e-12);
}

TEST(BenchTransport, NoiseIsRelativeToTheReferences) {
    const auto even = [](float value) {
        frame::Image image(4, 2, 3);
        std::ranges::fill(image.values, value);
        return image;
    };
    const ReferencePair truth(even(2.0f), even(2.0f));
    EXPECT_NEAR(relative_noise(even(2.5f), even(1.5f), truth), 0.5 / (4.0 + 0.04), 1e-12);
    EXPECT_EQ(relative_noise(even(3.0f), even(3.0f), truth), 0.0);
}

TEST(BenchTransport, MeasuresARealScene) {
    const References folder;
    const auto scene = load_scene("cornell", "");
    ASSERT_TRUE(scene);
    tbb::task_arena arena(2);
    const TransportPlan plan{.references = folder.path,
                             .scenes = {"cornell"},
                             .backends = {"embree"},
                             .spp = {1, 4, 16},
                             .reference_spp = 64,
                             .size = {48, 32},
                             .seeds = 2,
                             .jobs = 2};
    const auto measured = measure_transport(*scene, plan, arena, SilentProgress, {});
    ASSERT_TRUE(measured);
    ASSERT_EQ(measured->curves.size(), 1u);
    const std::vector<TransportPoint>& points = measured->curves[0].points;
    ASSERT_EQ(points.size(), 3u);
    for (const TransportPoint& point : points) {
        EXPECT_NEAR(point.light, 1.0, 5.0 * point.light_deviation) << point.spp;
        EXPECT_GT(point.rays, 2.0) << "a camera ray and a shadow ray at least";
        EXPECT_LT(point.rays, 20.0);
        EXPECT_GT(point.flip, 0.0);
    }
    EXPECT_LT(points[2].relmse.value, 0.4 * points[0].relmse.value);
    EXPECT_LT(points[2].light_deviation, points[0].light_deviation);
    EXPECT_GT(measured->curves[0].first_picture_seconds, 0.0);
    EXPECT_EQ(measured->curves[0].samples.samples(), 48u * 32u * HistogramSeeds);
    const std::vector<PathDepth>& depths = measured->curves[0].depths;
    ASSERT_EQ(depths.size(), 4u) << "direct light, one and two bounces, whole paths";
    EXPECT_LT(depths[0].light, depths[1].light);
    EXPECT_LT(depths[2].light, depths[3].light);
    EXPECT_NEAR(depths[3].light, 1.0, 5.0 * points[2].light_deviation);
    for (const PathDepth& depth : depths) EXPECT_GT(depth.noise, 0.0);
    // Two films of as many samples: the same error, to a factor of the outliers.
    EXPECT_NEAR(depths[3].noise / points[2].relmse.value, 1.0, 0.6);

    const auto json = nlohmann::json::parse(transport_json({*measured}, plan));
    EXPECT_EQ(json["scenes"][0]["curves"][0]["depths"][1]["bounces"], 1);
    EXPECT_EQ(json["scenes"][0]["curves"][0]["points"].size(), 3u);
    EXPECT_EQ(json["scenes"][0]["curves"][0]["histogram"]["samples"], 48 * 32 * HistogramSeeds);
    EXPECT_TRUE(json["mean_time_to_equal_error_over_cycles"]["embree"].is_null()) << "Cycles did not run";
    EXPECT_NE(transport_html({*measured}, plan).find("<svg viewBox"), std::string::npos);
    EXPECT_NE(transport_svg({*measured}).find("xmlns"), std::string::npos);
    EXPECT_NE(transport_text(*measured, plan).find("embree"), std::string::npos);
}

TEST(BenchTransport, StopsOnRequest) {
    const References folder;
    const auto scene = load_scene("cornell", "");
    tbb::task_arena arena(2);
    std::stop_source stop;
    stop.request_stop();
    const TransportPlan plan{.references = folder.path,
                             .backends = {"embree"},
                             .spp = {1},
                             .reference_spp = 4,
                             .size = {16, 16},
                             .seeds = 1,
                             .jobs = 2};
    EXPECT_FALSE(measure_transport(*scene, plan, arena, SilentProgress, stop.get_token()));
}

}  // namespace
}  // namespace tessera::tools::bench
