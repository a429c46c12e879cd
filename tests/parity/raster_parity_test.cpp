// Rasterised pictures match those of Embree's rays.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "mediator/frame/resolve.h"
#include "tests/parity/both.h"

namespace tessera::test {
namespace {

constexpr std::uint32_t RasterSize = 64, Batches = 16, Level = 3;

// Means of batches of samples over the picture, of one component.
struct BatchMeans {
    double sum = 0.0, squares = 0.0;

    void add(double mean) {
        sum += mean;
        squares += mean * mean;
    }
    double mean() const { return sum / Batches; }
    double variance_of_mean() const {
        return std::max(0.0, squares - sum * sum / Batches) / (Batches - 1.0) / Batches;
    }
};

std::array<BatchMeans, 3> means_of(const Renderer& renderer, const view::View& view, frame::Channel channel) {
    std::array<BatchMeans, 3> means;
    for (std::uint64_t batch = 0; batch < Batches; ++batch) {
        const frame::Image image =
            frame::resolve(renderer.film(view, view.window, {batch << Level, Level}), channel);
        std::array<double, 3> sums{};
        for (std::size_t i = 0; i < image.values.size(); ++i) sums[i % 3] += image.values[i];
        for (std::size_t c = 0; c < 3; ++c) means[c].add(sums[c] / (RasterSize * RasterSize));
    }
    return means;
}

class RasterParity : public testing::TestWithParam<const char*> {};

// The subpixel positions differ, so means are compared: each within 4 standard errors of the difference,
// which a correct renderer exceeds in 1 of 1,300 runs of these 12 numbers; the samples are fixed.
TEST_P(RasterParity, MatchesTheMeansOfTracedRays) {
    const tools::bench::BenchScene scene = bench_scene(GetParam());
    const Renderer embree("embree", scene), vulkan("vulkan", scene);
    view::View view = square_view(scene, RasterSize);
    for (const frame::Channel channel : {frame::Channel::Radiance, frame::Channel::Albedo}) {
        view.renderer = view::Renderer::Whitted;
        const auto traced = means_of(embree, view, channel);
        view.renderer = view::Renderer::Raster;
        const auto drawn = means_of(vulkan, view, channel);
        for (std::size_t c = 0; c < 3; ++c) {
            const double error = std::sqrt(traced[c].variance_of_mean() + drawn[c].variance_of_mean());
            const double difference = drawn[c].mean() - traced[c].mean();
            std::printf("%s, %s %zu: %.5f +- %.5f of %.5f\n", GetParam(),
                        std::string(frame::info(channel).name).c_str(), c, difference, error,
                        traced[c].mean());
            EXPECT_GT(traced[c].mean(), 0.0);
            EXPECT_LE(error, 0.02 * traced[c].mean()) << "this test would see little";
            EXPECT_LE(std::fabs(difference), 4.0 * error);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, RasterParity, testing::Values("cornell", "room-1"), [](const auto& test) {
    std::string name = test.param;
    std::erase(name, '-');
    return name;
});

}  // namespace
}  // namespace tessera::test
