// The convergence blend, which prevents a denoiser from worsening a converged picture (L36).
#include "master/filter/convergence_blend.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/filter/synthetic.h"

namespace tessera::filter {
namespace {

using frame::Channel;

constexpr std::uint32_t FadeWidth = 96, FadeHeight = 96;

// Pixel values are 0 or `found` with probability truth / found: exact sums of n such samples.
Inputs noisy(const Planes& truth, std::uint32_t n, float found = 1.0f, std::uint64_t seed = 1) {
    Inputs inputs;
    inputs.width = truth.width();
    inputs.height = truth.height();
    inputs.counts = Planes(inputs.width, inputs.height, 1);
    inputs.means[0] = Planes(inputs.width, inputs.height, 3);
    inputs.variances[0] = Planes(inputs.width, inputs.height, 3);
    std::mt19937_64 random(seed * 1000 + n);
    for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
        inputs.counts.plane(0)[i] = static_cast<float>(n);
        for (std::uint32_t c = 0; c < 3; ++c) {
            const double p = truth.plane(c)[i] / found;
            const double rate = std::binomial_distribution<std::uint32_t>(n, p)(random) / double(n);
            inputs.means[0].plane(c)[i] = static_cast<float>(found * rate);
            inputs.variances[0].plane(c)[i] =
                n < 2 ? 0.0f : static_cast<float>(found * found * rate * (1.0 - rate) / (n - 1.0));
        }
    }
    return inputs;
}

Planes uniform(float value) {
    Planes planes(FadeWidth, FadeHeight, 3);
    std::ranges::fill(planes.values(), value);
    return planes;
}

double error_against(const Planes& picture, const Planes& truth) {
    double mean = 0.0, sum = 0.0;
    const std::size_t count = truth.values().size();
    for (const float t : truth.values()) mean += t / double(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double t = truth.values()[i], d = picture.values()[i] - t;
        sum += d * d / (t * t + 0.01 * mean * mean);
    }
    return sum / double(count);
}

Planes blended(const Inputs& inputs, const Planes& filtered, std::span<const float> self_weight = {},
               Planes* weights = nullptr) {
    ConvergenceBlend blend;
    Planes picture = filtered;
    tbb::task_arena arena(2);
    RunContext context{arena, {}};
    EXPECT_TRUE(blend.apply(inputs, frame::Channel::Radiance, self_weight, picture, context));
    if (weights != nullptr) *weights = blend.weights();
    return picture;
}

double mean(std::span<const float> values) {
    double sum = 0.0;
    for (const float v : values) sum += v;
    return sum / double(values.size());
}
double mean(const Planes& planes) {
    return mean(planes.values());
}

// Of the coarsest band of independent noise of variance 1, [1 2 3 4 3 2 1] / 16 in both directions.
constexpr double CoarseNoise = (44.0 / 256.0) * (44.0 / 256.0);

TEST(ConvergenceBlend, NeverWorseThanUnfilteredAtAnyNumberOfSamples) {
    const Planes truth = shadowed_texture_truth(FadeWidth, FadeHeight);
    bool blur_was_worse = false;
    for (const char* blur : {"gauss:sigma=0.7", "gauss:sigma=2", "gauss:sigma=6"}) {
        for (std::uint32_t n = 4; n <= 4096; n *= 4) {
            const Inputs inputs = noisy(truth, n);
            const Planes filtered = run_filter(blur, inputs).picture;
            const double unfiltered = error_against(inputs.mean(Channel::Radiance), truth);
            blur_was_worse |= error_against(filtered, truth) > 2.0 * unfiltered;
            EXPECT_LE(error_against(blended(inputs, filtered), truth), 1.05 * unfiltered) << blur << " " << n;
        }
    }
    EXPECT_TRUE(blur_was_worse);
}

TEST(ConvergenceBlend, KeepsAnUnbiasedFilter) {
    const Planes truth = uniform(0.3f);
    for (const std::uint32_t n : {4u, 64u, 4096u}) {
        Planes weights;
        const Inputs inputs = noisy(truth, n);
        blended(inputs, truth, {}, &weights);
        EXPECT_GT(mean(weights), 0.94) << n;
    }
}

TEST(ConvergenceBlend, FallsWithTheSamplesWhereTheFilterIsBiased) {
    const Planes truth = uniform(0.3f), wrong = uniform(0.4f);
    // The bias is in the coarsest band alone: w = V / (V + bias^2) with V = CoarseNoise * 0.3 * 0.7 / n.
    for (const std::uint32_t n : {16u, 256u, 65536u}) {
        Planes weights;
        blended(noisy(truth, n), wrong, {}, &weights);
        const double variance = CoarseNoise * 0.21 / n;
        EXPECT_NEAR(mean(weights.plane(2)), variance / (variance + 0.01), 0.03) << n;
        EXPECT_GT(mean(weights.plane(0)), 0.9) << n;
    }
}

TEST(ConvergenceBlend, CorrectsASmoothBiasWithoutTheNoiseOfTheSamples) {
    const Planes truth = uniform(0.3f), wrong = uniform(0.4f);
    for (const std::uint32_t n : {4u, 64u, 1024u}) {
        const Inputs inputs = noisy(truth, n);
        const Planes out = blended(inputs, wrong);
        const double best =
            std::min(error_against(inputs.mean(Channel::Radiance), truth), error_against(wrong, truth));
        EXPECT_LT(error_against(out, truth), 0.2 * best) << n;
        EXPECT_NEAR(mean(out), mean(inputs.mean(Channel::Radiance)), n == 4 ? 0.02 : 0.004) << n;
    }
}

TEST(ConvergenceBlend, AccountsForTheSelfWeight) {
    // F = U + half of the distance to another truth: the covariance is V / 2.
    const Planes truth = uniform(0.3f);
    const Inputs inputs = noisy(truth, 64);
    Planes filtered(FadeWidth, FadeHeight, 3);
    for (std::size_t i = 0; i < filtered.values().size(); ++i) {
        filtered.values()[i] = 0.5f * inputs.means[0].values()[i] + 0.5f * 0.4f;
    }
    const std::vector<float> half(inputs.pixel_count(), 0.5f);
    Planes weights;
    blended(inputs, filtered, half, &weights);
    const double variance = CoarseNoise * 0.21 / 64;
    EXPECT_NEAR(mean(weights.plane(2)), 0.5 * variance / (0.25 * (variance + 0.01)), 0.02);
}

TEST(ConvergenceBlend, DoesNotKeepRareLightAsSpots) {
    // 2 % of the samples find light of 50: at 4 samples nine of ten pixels have found none.
    const Planes truth = uniform(1.0f);
    for (const std::uint32_t n : {4u, 16u, 64u}) {
        const Inputs inputs = noisy(truth, n, 50.0f);
        const double unfiltered = error_against(inputs.mean(Channel::Radiance), truth);
        const Planes out = blended(inputs, truth);
        // At 4 samples a square contains nine finds: are the pixels around them dark?
        EXPECT_LT(error_against(out, truth), (n == 4 ? 0.05 : 0.02) * unfiltered) << n;
        EXPECT_NEAR(mean(out), 1.0, 0.02) << n;  // and none of it is lost
    }
}

TEST(ConvergenceBlend, DoesNotBrightenTheDarkWithRareLight) {
    // A caustic of 20 pixels in the dark, found by one sample in 500: the filter spreads it over its surroundings.
    Planes truth = uniform(0.1f);
    for (std::uint32_t x = 40; x < 60; ++x) {
        for (std::uint32_t c = 0; c < 3; ++c) truth.row(c, 48)[x] = 3.0f;
    }
    bool spread = false;
    for (const std::uint32_t n : {4u, 16u, 64u}) {
        double unfiltered = 0.0, filtered = 0.0, out = 0.0, sampled = 0.0, energy = 0.0;
        for (std::uint64_t seed = 1; seed <= 8; ++seed) {
            Inputs inputs = noisy(truth, n, 1500.0f, seed);
            for (std::size_t k = 0; k < truth.values().size(); ++k) {
                if (truth.values()[k] > 1.0f) continue;
                inputs.means[0].values()[k] = 0.1f;
                inputs.variances[0].values()[k] = 1e-8f;
            }
            const Planes blur = run_filter("gauss:sigma=3", inputs).picture;
            const Planes picture = blended(inputs, blur);
            unfiltered += error_against(inputs.mean(Channel::Radiance), truth);
            filtered += error_against(blur, truth);
            out += error_against(picture, truth);
            sampled += mean(inputs.mean(Channel::Radiance));
            energy += mean(picture);
        }
        spread |= filtered > 1.05 * unfiltered;
        EXPECT_LE(out, 1.08 * unfiltered) << n;
        EXPECT_NEAR(energy, sampled, 0.02 * sampled) << n;
    }
    EXPECT_TRUE(spread);
}

// One strong find among weak ones, all of which the denoiser spread: its neighbours found nothing.
TEST(ConvergenceBlend, KeepsASingleFindOutOfItsNeighbours) {
    Inputs inputs = noisy(uniform(0.05f), 4, 2.0f);
    const Planes filtered = uniform(0.1f);
    const std::size_t at = 40 * FadeWidth + 40;
    for (std::uint32_t c = 0; c < 3; ++c) {
        inputs.means[0].plane(c)[at] = 3.0f;
        inputs.variances[0].plane(c)[at] = 9.0f;
        for (const std::size_t neighbour : {at - 1, at + 1, at - FadeWidth, at + FadeWidth})
            inputs.means[0].plane(c)[neighbour] = inputs.variances[0].plane(c)[neighbour] = 0.0f;
    }
    const Planes out = blended(inputs, filtered);
    for (const std::size_t neighbour : {at - 1, at + 1, at - FadeWidth, at + FadeWidth})
        EXPECT_LT(out.plane(0)[neighbour], 0.13f);  // 0.23 without the limit
}

// Every other column is in shadow, which each sample sees; the noise of the lit ones is not rare light.
TEST(ConvergenceBlend, DoesNotFillFineShadows) {
    Planes truth = uniform(0.1f);
    Inputs inputs = noisy(uniform(0.5f), 64);
    for (std::uint32_t c = 0; c < 3; ++c) {
        for (std::uint32_t y = 0; y < FadeHeight; ++y) {
            for (std::uint32_t x = 0; x < FadeWidth; ++x) {
                float &mean = inputs.means[0].row(c, y)[x], &variance = inputs.variances[0].row(c, y)[x];
                mean = x % 2 == 0 ? 0.5f + 2.0f * mean : 0.1f;  // 1.5 on average
                variance *= x % 2 == 0 ? 4.0f : 0.0f;
                truth.row(c, y)[x] = x % 2 == 0 ? 1.5f : 0.1f;
            }
        }
    }
    const double unfiltered = error_against(inputs.mean(Channel::Radiance), truth);
    EXPECT_GT(error_against(uniform(0.8f), truth), 100.0 * unfiltered);
    EXPECT_LT(error_against(blended(inputs, uniform(0.8f)), truth), 1.08 * unfiltered);
}

// A filter that is too dark by a tenth, where one sample in 50 finds light: what the samples missed is dark, too.
TEST(ConvergenceBlend, GivesBackTheLightOfTheWholePicture) {
    const Planes truth = uniform(1.0f), dim = uniform(0.9f);
    for (const std::uint32_t n : {4u, 16u, 64u}) {
        const Inputs inputs = noisy(truth, n, 50.0f);
        const double sampled = mean(inputs.mean(Channel::Radiance));
        const Planes out = blended(inputs, dim);
        EXPECT_NEAR(mean(out), sampled, 0.015 * sampled) << n;
        EXPECT_LT(error_against(out, truth), 0.1 * error_against(inputs.mean(Channel::Radiance), truth)) << n;
    }
}

TEST(ConvergenceBlend, RemovesAFirefly) {
    const Planes truth = uniform(0.5f);
    Inputs inputs = noisy(truth, 1024);
    const std::size_t at = 40 * FadeWidth + 40;
    for (std::uint32_t c = 0; c < 3; ++c) {
        inputs.means[0].plane(c)[at] = 1000.0f;  // one sample of 1024000
        inputs.variances[0].plane(c)[at] = 1e6f;
    }
    EXPECT_NEAR(blended(inputs, truth).plane(0)[at], 0.5f, 0.03f);
}

TEST(ConvergenceBlend, FillsHolesAndKeepsTheFilteredValueAtOneSample) {
    const Planes truth = uniform(0.5f), wrong = uniform(5.0f);
    Inputs inputs = noisy(truth, 65536);
    for (const std::size_t i : {std::size_t{100}, std::size_t{5000}}) {
        inputs.counts.plane(0)[i] = i == 100 ? 0.0f : 1.0f;
        for (std::uint32_t c = 0; c < 3; ++c) {
            inputs.means[0].plane(c)[i] = inputs.variances[0].plane(c)[i] = 0.0f;
        }
    }
    const Planes out = blended(inputs, wrong);
    EXPECT_EQ(out.plane(1)[100], 5.0f);
    EXPECT_EQ(out.plane(1)[5000], 5.0f);
    EXPECT_NEAR(out.plane(1)[101], 0.5f, 0.01f);

    const Planes all_unknown = blended(noisy(truth, 1), wrong);
    for (const float v : all_unknown.values()) ASSERT_EQ(v, 5.0f);
}

TEST(ConvergenceBlend, PixelsWithoutVarianceDoNotContribute) {
    const Planes truth = uniform(0.5f);
    Inputs inputs = noisy(truth, 4);
    for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
        if (i % 4 == 0) continue;
        inputs.counts.plane(0)[i] = static_cast<float>(i % 2);
        for (std::uint32_t c = 0; c < 3; ++c) {
            inputs.means[0].plane(c)[i] = inputs.variances[0].plane(c)[i] = 0.0f;
        }
    }
    Planes weights;
    blended(inputs, truth, {}, &weights);
    double sum = 0.0;
    for (std::size_t i = 0; i < inputs.pixel_count(); i += 4) sum += weights.plane(0)[i];
    EXPECT_GT(sum / (double(inputs.pixel_count()) / 4.0), 0.85);
}

TEST(ConvergenceBlend, BrightPixelsDoNotDominateDarkOnes) {
    // A noisy region of 1000 next to a converged one of 1 whose filtered value is wrong.
    Planes truth(FadeWidth, FadeHeight, 3), filtered(FadeWidth, FadeHeight, 3);
    for (std::size_t i = 0; i < truth.values().size(); ++i) {
        const bool bright = i % FadeWidth < FadeWidth / 2;
        truth.values()[i] = bright ? 1000.0f : 1.0f;
        filtered.values()[i] = bright ? 1000.0f : 300.0f;
    }
    Inputs inputs = noisy(truth, 16, 2000.0f);
    for (std::uint32_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
            if (i % FadeWidth < FadeWidth / 2) continue;
            inputs.means[0].plane(c)[i] = 1.0f;
            inputs.variances[0].plane(c)[i] = 1e-6f;
        }
    }
    const Planes out = blended(inputs, filtered);
    EXPECT_LT(out.row(0, 48)[FadeWidth / 2], 100.0f);
    // Their own neighbours dominate, since the square contains many noisy pixels.
    EXPECT_LT(out.row(0, 48)[FadeWidth / 2 + 1], 20.0f);
    EXPECT_NEAR(out.row(0, 48)[FadeWidth / 2 + 6], 1.0f, 0.01f);
}

TEST(ConvergenceBlend, FiniteAtExtremes) {
    for (const float scale : {0.0f, 1e-30f, 1e-12f, 1e12f, 1e30f}) {
        Inputs inputs = noisy(uniform(0.5f), 16);
        Planes filtered = uniform(0.4f * scale);
        for (float& v : inputs.means[0].values()) v *= scale;
        for (float& v : inputs.variances[0].values()) v = std::min(v * scale, 1e30f) * std::min(scale, 1.0f);
        for (std::size_t i = 0; i < filtered.values().size(); i += 97) filtered.values()[i] = 1e30f;
        const auto result = blended(inputs, filtered);
        for (const float v : result.values()) ASSERT_TRUE(std::isfinite(v)) << scale;
    }
}

// Next to bright light the coarse band is large and negative.
TEST(ConvergenceBlend, LeavesNoNegativeLight) {
    const Planes truth = uniform(0.01f);
    Planes filtered = truth;
    Inputs inputs = noisy(truth, 256);
    for (std::uint32_t c = 0; c < 3; ++c) {
        for (std::uint32_t y = 40; y < 50; ++y) std::fill_n(filtered.row(c, y) + 40, 10, 1e6f);
    }
    const Planes out = blended(inputs, filtered);
    for (const float v : out.values()) {
        ASSERT_GE(v, 0.0f);
        ASSERT_LE(v, 1e6f);
    }
}

// Sums are made in blocks of rows, which lie differently in a picture that is upside down.
TEST(ConvergenceBlend, OfAPictureUpsideDownIsUpsideDown) {
    const auto flipped = [](const Planes& planes) {
        Planes out = planes;
        for (std::uint32_t c = 0; c < planes.components(); ++c) {
            for (std::uint32_t y = 0; y < planes.height(); ++y)
                std::copy_n(planes.row(c, y), planes.width(), out.row(c, planes.height() - 1 - y));
        }
        return out;
    };
    for (const auto& [width, height] : {std::pair{37u, 29u}, {5u, 3u}, {1u, 1u}, {20u, 17u}}) {
        const Planes truth = shadowed_texture_truth(width, height);
        Inputs inputs = noisy(truth, 64);
        const Planes filtered = run_filter("gauss:sigma=2", inputs).picture;
        const Planes out = blended(inputs, filtered);
        inputs.means[0] = flipped(inputs.means[0]);
        inputs.variances[0] = flipped(inputs.variances[0]);
        const Planes other = flipped(blended(inputs, flipped(filtered)));
        for (std::size_t i = 0; i < out.values().size(); ++i)
            ASSERT_NEAR(out.values()[i], other.values()[i], 1e-5f);
    }
}

// The right third is transparent: the light that the blend gives back does not show there.
TEST(ConvergenceBlend, AlphaWithTheSameWeight) {
    const Planes truth = uniform(0.3f);
    Inputs inputs = noisy(truth, 64);
    auto& alpha = inputs.means[static_cast<std::size_t>(Channel::Alpha)];
    alpha = Planes(FadeWidth, FadeHeight, 1);
    const auto is_opaque = [](std::size_t i) { return i % FadeWidth < 64; };
    for (std::size_t i = 0; i < inputs.pixel_count(); ++i) alpha.values()[i] = is_opaque(i) ? 1.0f : 0.0f;
    Planes filtered(FadeWidth, FadeHeight, 4), weights;
    std::ranges::fill(filtered.values(), 0.0f);
    const Planes out = blended(inputs, filtered, {}, &weights);
    for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
        const float kept = 1.0f - weights.plane(0)[i];
        ASSERT_GE(out.plane(3)[i], is_opaque(i) ? kept : 0.0f);
        ASSERT_LE(out.plane(3)[i], is_opaque(i) ? 1.0f : 0.0f);
        const float own = kept * inputs.means[0].plane(0)[i];
        ASSERT_GE(out.plane(0)[i], own - 1e-6f);
        if (!is_opaque(i)) ASSERT_NEAR(out.plane(0)[i], own, 1e-6f);
    }
}

TEST(ConvergenceBlend, SameBitsForAnyNumberOfThreadsAndStopsOnRequest) {
    const Inputs inputs = noisy(shadowed_texture_truth(FadeWidth, FadeHeight), 16);
    const Planes filtered = run_filter("gauss:sigma=3", inputs).picture;
    ConvergenceBlend blend;
    Planes one = filtered, two = filtered;
    tbb::task_arena single(1), pair(2);
    RunContext alone{single, {}}, together{pair, {}};
    EXPECT_TRUE(blend.apply(inputs, frame::Channel::Radiance, {}, one, alone));
    EXPECT_TRUE(blend.apply(inputs, frame::Channel::Radiance, {}, two, together));
    EXPECT_TRUE(std::ranges::equal(one.values(), two.values()));

    std::stop_source source;
    source.request_stop();
    RunContext stopped{pair, source.get_token()};
    EXPECT_FALSE(blend.apply(inputs, frame::Channel::Radiance, {}, two, stopped));
}

}  // namespace
}  // namespace tessera::filter
