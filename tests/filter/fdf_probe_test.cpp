// How much of the samples' own noise the feature distance filter keeps, as its probe measures it.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "master/filter/fdf/feature_bilateral.h"
#include "master/filter/fdf/nl_means.h"
#include "tests/filter/synthetic.h"

namespace tessera::filter {
namespace {

using frame::Channel;

constexpr std::uint32_t ProbeSize = 64;

// A soft shadow on a plain wall: light and shading rise from left to right, with ripples, and the same noise in both.
struct SoftShadow {
    SoftShadow(float deviation, std::uint64_t seed, float ripple = 0.0f) {
        inputs = synthetic_inputs(ProbeSize, ProbeSize, 4,
                                  [](auto, auto, auto) { return SyntheticSample{.depth = 1.0f}; });
        std::mt19937_64 random(seed);
        std::normal_distribution<float> normal;
        for (std::uint32_t y = 0; y < ProbeSize; ++y) {
            for (std::uint32_t x = 0; x < ProbeSize; ++x) {
                const float light = 0.5f + static_cast<float>(x) / ProbeSize +
                                    ripple * std::sin(0.8f * static_cast<float>(x + y));
                set(x, y, light, light + deviation * normal(random), deviation * deviation);
            }
        }
    }
    void set(std::uint32_t x, std::uint32_t y, float light, float value, float variance) {
        const auto at = [&](auto& planes, Channel channel, std::uint32_t c) -> float& {
            return planes[static_cast<std::size_t>(channel)].row(c, y)[x];
        };
        for (std::uint32_t c = 0; c < 3; ++c) {
            truth.row(c, y)[x] = light;
            at(inputs.means, Channel::Radiance, c) = value;
            at(inputs.variances, Channel::Radiance, c) = variance;
        }
        at(inputs.means, Channel::ShadingFeature, 0) = value;
        at(inputs.variances, Channel::ShadingFeature, 0) = variance;
    }
    Inputs inputs;
    Planes truth{ProbeSize, ProbeSize, 3};
};

struct Measured {
    Measured() : arena(2), context{arena, {}} {
        std::ranges::fill(classes.values(), static_cast<float>(PixelClass::Surface));
        std::mt19937 random(3);
        for (float& sign : signs.values()) sign = random() % 2 == 0 ? 1.0f : -1.0f;
    }
    // sum of responses times changes over that of squared changes: the mean of dF/dU.
    double run(const Inputs& inputs, const FeatureSettings& settings, float shading_deviation) {
        for (std::size_t i = 0; i < moved.values().size(); ++i)
            moved.values()[i] = shading_deviation * signs.values()[i];
        const Probe probe{signs, moved, change, response};
        EXPECT_TRUE(filter.run(inputs, inputs.mean(Channel::ShadingFeature), classes, settings, picture,
                               self_weight, context, &probe));
        double above = 0.0, below = 0.0;
        for (std::size_t i = 0; i < change.values().size(); ++i) {
            above += double(response.values()[i]) * double(change.values()[i]);
            below += double(change.values()[i]) * double(change.values()[i]);
        }
        return above / below;
    }
    tbb::task_arena arena;
    RunContext context;
    FeatureBilateral filter;
    Planes classes{ProbeSize, ProbeSize, 1}, signs{ProbeSize, ProbeSize, 1}, moved{ProbeSize, ProbeSize, 1},
        change{ProbeSize, ProbeSize, 1}, response{ProbeSize, ProbeSize, 1},
        self_weight{ProbeSize, ProbeSize, 1}, picture{ProbeSize, ProbeSize, 4};
};

// Windows of 3 x 3 equal pixels: a ninth inside, more at borders.
TEST(FdfProbe, WithoutNoiseInTheFeaturesItIsTheOwnWeight) {
    const SoftShadow shadow(0.1f, 1);
    Measured measured;
    const double a = measured.run(shadow.inputs, {.radius = 1, .s_max = 1e6f}, 0.0f);
    EXPECT_NEAR(a, 1.0 / 9.0, 0.02);
    EXPECT_NEAR(measured.self_weight.row(0, 32)[32], 1.0 / 9.0, 1e-4);
}

// Against the change of single pixels, of light and shading at once.
TEST(FdfProbe, ItCountsNoiseThatTheFeaturesShare) {
    const float deviation = 0.05f;
    const FeatureSettings settings{.radius = 3, .s_max = 1.0f};
    const SoftShadow shadow(deviation, 2);
    Measured measured;
    const double a = measured.run(shadow.inputs, settings, deviation);
    const Planes before = measured.picture;
    double expected = 0.0, own = 0.0, count = 0.0;
    for (std::uint32_t y = 8; y < ProbeSize - 8; y += 8) {
        for (std::uint32_t x = 8; x < ProbeSize - 8; x += 4) {
            SoftShadow moved = shadow;
            const float step = 0.25f * deviation;
            const float value = shadow.inputs.mean(Channel::Radiance).row(0, y)[x];
            moved.set(x, y, 0.0f, value + step, deviation * deviation);
            measured.run(moved.inputs, settings, deviation);
            expected += (measured.picture.row(0, y)[x] - before.row(0, y)[x]) / step;
            own += measured.self_weight.row(0, y)[x];
            count += 1.0;
        }
    }
    EXPECT_NEAR(a, expected / count, 0.15 * expected / count);
    EXPECT_GT(expected, 1.5 * own);
}

// Ripples of twice the noise are kept in part, and so is the noise. Taken for noise that was removed, it would hide
// some of the bias: the error is 0.52 of the unfiltered instead of 0.47.
TEST(FdfProbe, TheConvergenceBlendKnowsIt) {
    double error = 0.0, unfiltered = 0.0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        SoftShadow shadow(0.01f, seed, 0.02f);
        std::ranges::fill(shadow.inputs.counts.values(), 64.0f);
        error += mean_squared_error(run_filter("fdf", shadow.inputs).picture, shadow.truth);
        unfiltered += mean_squared_error(shadow.inputs.mean(Channel::Radiance), shadow.truth);
    }
    EXPECT_LT(error, 0.495 * unfiltered);
}

// The prefilter passes changes on with the weights that it gives to the values.
TEST(FdfProbe, ThePrefilterAveragesChangesLikeValues) {
    const SoftShadow shadow(0.1f, 4);
    Measured measured;
    const Planes& values = shadow.inputs.mean(Channel::ShadingFeature);
    const Planes& variances = shadow.inputs.variance(Channel::ShadingFeature);
    Planes filtered(ProbeSize, ProbeSize, 1), alone(ProbeSize, ProbeSize, 1),
        changes(ProbeSize, ProbeSize, 1);
    NlMeans means;
    ASSERT_TRUE(
        means.run(values, variances, measured.classes, {}, filtered, measured.context, &values, &changes));
    ASSERT_TRUE(means.run(values, variances, measured.classes, {}, alone, measured.context));
    for (std::size_t i = 0; i < changes.values().size(); ++i) {
        EXPECT_EQ(changes.values()[i], filtered.values()[i]);
        EXPECT_EQ(alone.values()[i], filtered.values()[i]);
    }
}

}  // namespace
}  // namespace tessera::filter
