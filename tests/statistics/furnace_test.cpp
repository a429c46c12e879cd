// White furnace: in a closed box whose walls emit 1 and reflect the share a, radiance is the geometric
// series.
#include "tests/statistics/furnace.h"

#include <gtest/gtest.h>

#include <cmath>

#include "backends/embree/path_tracer.h"

namespace tessera::embree {
namespace {

struct Estimate {
    double mean = 0, standard_error = 0;
};

Estimate radiance(const Furnace& furnace, std::uint32_t max_bounces, Strategy strategy, std::uint64_t spp) {
    view::View view;
    view.width = view.height = 64;
    view.seed = 7;
    view.camera = view::perspective(glm::dmat4(1.0), 1.0, 1.0);
    view.max_bounces = max_bounces;
    const PathTracer tracer(furnace.world.tables(), furnace.world.scene(), view, strategy);
    double sum = 0, squares = 0, count = 0;
    std::uint64_t rays = 0;
    for (std::uint64_t sample = 0; sample < spp; ++sample) {
        for (std::uint32_t y = 0; y < view.height; ++y) {
            for (std::uint32_t x = 0; x < view.width; ++x) {
                const PathSample found = tracer.trace(x, y, sample, rays);
                const double value = radiance_of(found).x;
                sum += value;
                squares += value * value;
                ++count;
            }
        }
    }
    const double mean = sum / count;
    return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean) / count)};
}

// 18 tests at 4 standard errors: 0.1 % of fixed seeds would fail a right tracer.
constexpr double FurnaceThreshold = 4.0;
constexpr double FurnaceRounding = 1e-5;  // float throughput over a few hundred vertices

void expect_value(const Estimate& estimate, double expected) {
    EXPECT_LE(estimate.standard_error, 0.003 * expected) << "too few samples to see 1 % of missing energy";
    EXPECT_NEAR(estimate.mean, expected,
                FurnaceThreshold * estimate.standard_error + FurnaceRounding * expected);
}

class WhiteFurnace : public testing::TestWithParam<float> {};

TEST_P(WhiteFurnace, UnlimitedBouncesGiveTheWholeSeries) {
    const Furnace furnace(GetParam());
    for (const Strategy strategy : {Strategy::Both, Strategy::BsdfOnly}) {
        expect_value(radiance(furnace, view::UnlimitedBounces, strategy, 32),
                     1.0 / (1.0 - double(GetParam())));
    }
}

// max_bounces = 0 is direct light, one scattering: N scatterings give (1 - a^(N + 1)) / (1 - a).
TEST_P(WhiteFurnace, LimitedBouncesGiveAPartialSum) {
    const Furnace furnace(GetParam());
    for (const std::uint32_t scatterings : {1u, 2u, 5u}) {
        const double a = GetParam(), expected = (1.0 - std::pow(a, scatterings + 1.0)) / (1.0 - a);
        expect_value(radiance(furnace, scatterings - 1, Strategy::Both, 16), expected);
    }
}

INSTANTIATE_TEST_SUITE_P(Albedos, WhiteFurnace, testing::Values(0.5f, 0.9f, 0.99f));

TEST(WhiteFurnace, LightSamplingAgreesWithTheOtherStrategies) {
    const Furnace furnace(0.5f);
    expect_value(radiance(furnace, 3, Strategy::LightsOnly, 48), (1.0 - std::pow(0.5, 5.0)) / 0.5);
}

}  // namespace
}  // namespace tessera::embree
