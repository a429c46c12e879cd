// How `tessera bench filters` computes errors and ratios.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mediator/base/error.h"
#include "mediator/base/random.h"
#include "tests/bench/filters/curve.h"
#include "tests/bench/filters/errors.h"

namespace tessera::tools::bench {
namespace {

constexpr std::uint32_t Width = 96, Height = 64;

// A smooth picture, from 0.2 to 1.
frame::Image truth() {
    frame::Image image(Width, Height, 3);
    for (std::size_t i = 0; i < image.values.size(); ++i) {
        image.values[i] = 0.6f + 0.4f * std::sin(0.01f * static_cast<float>(i));
    }
    return image;
}

// Normal noise of the given standard deviation (Box and Muller 1958).
frame::Image with_noise(frame::Image image, double deviation, std::uint64_t seed) {
    CounterRandom random(seed);
    for (float& value : image.values) {
        const double radius = std::sqrt(-2.0 * std::log(1.0 - random.uniform()));
        value += static_cast<float>(deviation * radius * std::cos(2.0 * std::numbers::pi * random.uniform()));
    }
    return image;
}

frame::Image shifted(frame::Image image, float by) {
    for (float& value : image.values) value += by;
    return image;
}

TEST(BenchErrors, NoiseOfTheReferencesIsNotCounted) {
    // References ten times noisier than the error that is measured.
    const frame::Image picture = shifted(truth(), 0.02f);
    double sum = 0.0, squares = 0.0, deviations = 0.0;
    constexpr int Trials = 60;
    for (std::uint64_t i = 0; i < Trials; ++i) {
        const ReferencePair pair(with_noise(truth(), 0.2, 2 * i + 1), with_noise(truth(), 0.2, 2 * i + 2));
        const Estimate mse = squared_errors(picture, pair).mse;
        sum += mse.value;
        squares += mse.value * mse.value;
        deviations += mse.deviation;
        EXPECT_NEAR(pair.noise_mse(), 0.04, 0.002);
    }
    const double mean = sum / Trials, spread = std::sqrt(squares / Trials - mean * mean);
    // Within four standard errors of the mean over the trials.
    EXPECT_NEAR(mean, 4e-4, 4.0 * spread / std::sqrt(double(Trials)));
    EXPECT_LT(spread, 4e-4);  // else the line above says nothing
    // What one measurement says of its own spread is right within the error of a spread over 60 trials.
    EXPECT_NEAR(deviations / Trials / spread, 1.0, 0.35);
}

TEST(BenchErrors, WithExactReferencesEqualsThePlainError) {
    const ReferencePair pair(truth(), truth());
    const SquaredErrors errors = squared_errors(shifted(truth(), 0.1f), pair);
    EXPECT_NEAR(errors.mse.value, 0.01, 1e-6);
    EXPECT_EQ(errors.mse.deviation, 0.0);
    EXPECT_EQ(pair.noise_relmse(), 0.0);
    double expected = 0.0;
    for (const float r : truth().values) expected += 0.01 / (double(r) * r + pair.epsilon());
    EXPECT_NEAR(errors.relmse.all.value, expected / double(truth().values.size()), 1e-6);
    EXPECT_EQ(perceptual_errors(truth(), pair).flip, 0.0);
    EXPECT_NEAR(perceptual_errors(truth(), pair).ssim, 1.0, 1e-9);
    EXPECT_GT(perceptual_errors(shifted(truth(), 0.1f), pair).flip, 0.0);
}

TEST(BenchErrors, TheWorstThousandthIsTrimmed) {
    frame::Image picture = shifted(truth(), 0.01f);
    const ReferencePair pair(truth(), truth());
    const RelativeErrors calm = squared_errors(picture, pair).relmse;
    EXPECT_NEAR(calm.trimmed.value / calm.all.value, 1.0, 0.05);
    constexpr std::size_t Fireflies = 6;  // of 6144 pixels, 7 are left out
    for (std::size_t i = 0; i < Fireflies; ++i) picture.values[3000 * i + 1] += 50.0f;
    const RelativeErrors spiky = squared_errors(picture, pair).relmse;
    EXPECT_GT(spiky.all.value, 100.0 * calm.all.value);
    EXPECT_NEAR(spiky.trimmed.value / calm.trimmed.value, 1.0, 0.05);
    for (std::size_t i = 0; i < 8; ++i) picture.values[2000 * i + 2] -= 50.0f;
    EXPECT_GT(squared_errors(picture, pair).relmse.trimmed.value, 100.0 * calm.all.value);
}

TEST(BenchErrors, AConstantErrorDoesNotFlicker) {
    const ReferencePair before(truth(), truth()), after(shifted(truth(), 0.3f), shifted(truth(), 0.3f));
    const frame::Image first = shifted(truth(), 0.05f), second = shifted(truth(), 0.35f);
    EXPECT_NEAR(temporal_relmse(first, second, before, after).all.value, 0.0, 1e-9);
    EXPECT_GT(temporal_relmse(first, shifted(second, 0.05f), before, after).all.value, 1e-3);
}

TEST(BenchErrors, IncompatibleReferencesAreRejected) {
    EXPECT_THROW(ReferencePair(truth(), frame::Image(Width, Height - 1, 3)), Error);
    EXPECT_THROW(ReferencePair(frame::Image(4, 4, 1), frame::Image(4, 4, 1)), Error);
    frame::Image infinite = truth();
    infinite.values[7] = INFINITY;
    EXPECT_THROW(ReferencePair(truth(), infinite), Error);
    const ReferencePair pair(truth(), truth());
    EXPECT_THROW(squared_errors(frame::Image(2, 2, 3), pair), Error);
}

TEST(BenchCurve, EquivalentSppRecoversAKnownFactor) {
    std::vector<CurvePoint> points;
    for (const double n : {1.0, 4.0, 16.0, 64.0}) points.push_back({n, 3.0 / n});
    const ErrorCurve curve(points);
    for (const double k : {1.0, 1.7, 4.0, 9.0}) {
        const ErrorCurve::Reading samples = curve.cost_of(3.0 / (4.0 * k));
        EXPECT_NEAR(samples.value / 4.0, k, 1e-9 * k);
        EXPECT_TRUE(samples.is_measured);
    }
    const ErrorCurve::Reading beyond = curve.cost_of(3.0 / 640.0);
    EXPECT_NEAR(beyond.value, 640.0, 1e-6);
    EXPECT_FALSE(beyond.is_measured);
    EXPECT_NEAR(curve.cost_of(6.0).value, 0.5, 1e-9);
    EXPECT_NEAR(curve.error_at(8.0).value, 3.0 / 8.0, 1e-9);
    EXPECT_NEAR(curve.error_at(256.0).value, 3.0 / 256.0, 1e-9);
    EXPECT_FALSE(curve.error_at(256.0).is_measured);
}

TEST(BenchCurve, InterpolatesOtherSlopesBetweenPoints) {
    const ErrorCurve curve({{4.0, 0.25}, {1.0, 1.0}, {16.0, 0.125}});  // any order; slopes -1 and -1/2
    EXPECT_NEAR(curve.cost_of(0.5).value, 2.0, 1e-9);
    EXPECT_NEAR(curve.cost_of(0.25 / std::sqrt(2.0)).value, 8.0, 1e-9);
    EXPECT_NEAR(curve.error_at(8.0).value, 0.25 / std::sqrt(2.0), 1e-9);
}

TEST(BenchCurve, NonPositiveValuesAreIgnored) {
    const ErrorCurve empty({{1.0, -0.1}, {4.0, 0.0}});
    EXPECT_EQ(empty.cost_of(0.1).value, 0.0);
    EXPECT_FALSE(empty.error_at(4.0).is_measured);
    const ErrorCurve curve({{1.0, 1.0}, {4.0, 0.25}});
    EXPECT_EQ(curve.cost_of(-1.0).value, 0.0);
    EXPECT_EQ(curve.error_at(0.0).value, 0.0);
}

}  // namespace
}  // namespace tessera::tools::bench
