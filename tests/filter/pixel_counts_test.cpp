// The pixel filter where pixels have different numbers of samples, as with adaptive sampling.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/filter/pixel_pictures.h"

namespace tessera::filter {
namespace {

constexpr std::uint32_t WallSize = 48;

using WallCounts = std::function<float(std::uint32_t x, std::uint32_t y)>;

// A plain wall of mean 1 whose samples have variance 1. Only the counts differ.
Inputs noisy_wall(std::uint64_t seed, const WallCounts& count) {
    return pixel_inputs(WallSize, WallSize, [&](std::uint32_t x, std::uint32_t y) {
        const float n = count(x, y);
        // Uniform numbers have variance 1/12.
        const float deviation = std::sqrt(12.0f / n) * (noise(seed, x, y) - 0.5f);
        return PixelLight{.high = 1.0f + deviation, .variance = 1.0f / n, .n = n};
    });
}

float few_or_many(std::uint32_t x, std::uint32_t y) {
    return noise(77, x, y) < 0.3f ? 64.0f : 4.0f;
}

// Mean of (value - 1)^2 of the inner pixels.
double wall_error(const Planes& picture) {
    double sum = 0.0, count = 0.0;
    for (std::uint32_t y = 8; y < WallSize - 8; ++y) {
        for (std::uint32_t x = 8; x < WallSize - 8; ++x) {
            sum += std::pow(double(picture.row(1, y)[x]) - 1.0, 2);
            count += 1.0;
        }
    }
    return sum / count;
}

// The kernel is as narrow as 256 samples allow, a quarter of 8 / sqrt(256), since it needs no wider one.
TEST(PixelCounts, WidthsFollowTheVarianceOfTheOwnMean) {
    const Inputs inputs =
        noisy_wall(5, [](std::uint32_t x, std::uint32_t y) { return x == 24 && y == 24 ? 256.0f : 16.0f; });
    const Output out = run_filter("pixel", inputs, true);
    EXPECT_FLOAT_EQ(map_of(out, "width").row(0, 24)[24], 0.125f);
    EXPECT_GT(map_of(out, "width").row(0, 24)[30], 1.0f);
}

// Its own error is 1 / 256, below the threshold 0.01.
TEST(PixelCounts, APixelWithManySamplesAmongOthersKeepsItsValue) {
    for (const char* choice : {"pixel:blend=off", "pixel:blend=off,adaptive=off",
                               "pixel:blend=off,method=brute", "pixel:blend=off,method=atrous"}) {
        const Inputs inputs = noisy_wall(
            5, [](std::uint32_t x, std::uint32_t y) { return x == 24 && y == 24 ? 256.0f : 16.0f; });
        const Output out = run_filter(choice, inputs, true);
        EXPECT_EQ(map_of(out, "blend").row(0, 24)[24], 1.0f) << choice;
        EXPECT_EQ(out.picture.row(1, 24)[24], inputs.color(1)[24 * WallSize + 24]) << choice;
        EXPECT_NEAR(map_of(out, "smoothed_variance").row(0, 24)[24], 1.0 / 256.0, 1e-4) << choice;
        EXPECT_LT(map_of(out, "blend").row(0, 24)[25], 1.0f) << choice;
    }
}

TEST(PixelCounts, TheMeanIsThatOverSamples) {
    const Inputs inputs = pixel_inputs(WallSize, WallSize, [](std::uint32_t x, std::uint32_t y) {
        const bool many = (x + y) % 2 == 0;
        return PixelLight{.high = many ? 1.0f : 0.0f,
                          .variance = 1.0f,
                          .n = many ? 48.0f : 16.0f,
                          .alpha = many ? 1.0f : 0.0f};
    });
    for (const char* method : {"separable", "brute", "atrous"}) {
        const Output out = run_filter(FilteredLight + ",method=" + method, inputs);
        EXPECT_NEAR(out.picture.row(0, 24)[24], 0.75f, 0.01f) << method;
        EXPECT_NEAR(out.picture.row(3, 24)[24], 0.75f, 0.01f) << method;
    }
}

// The same pictures, once without the knowledge that counts differ.
TEST(PixelCounts, TheErrorIsBelowThatOfTheMeanOverPixels) {
    for (const char* method : {"separable", "brute", "atrous"}) {
        double knowing = 0.0, ignorant = 0.0;
        for (std::uint64_t seed = 1; seed <= 8; ++seed) {
            Inputs inputs = noisy_wall(seed, few_or_many);
            const std::string choice = FilteredLight + ",sigma_s=3,method=" + method;
            knowing += wall_error(run_filter(choice, inputs).picture);
            for (float& n : inputs.counts.plane(0)) n = 16.0f;
            ignorant += wall_error(run_filter(choice, inputs).picture);
        }
        // 1 / mean(n) = 1 / 22 over mean(1 / n) = 1 / 5.6.
        EXPECT_LT(knowing, 0.35 * ignorant) << method;
    }
}

// r is relative to the variance of the pixel's own mean, which differs between pixels.
TEST(PixelCounts, TheReductionIsTheRemainingVariance) {
    constexpr int Seeds = 200;
    for (const char* method : {"separable", "brute", "atrous"}) {
        std::vector<double> sum(WallSize * WallSize, 0.0), squares(WallSize * WallSize, 0.0);
        Planes reduction;
        for (int seed = 0; seed < Seeds; ++seed) {
            const Inputs inputs = noisy_wall(100 + static_cast<std::uint64_t>(seed), few_or_many);
            const Output out = run_filter(FilteredLight + ",sigma_s=3,method=" + method, inputs, true);
            reduction = map_of(out, "reduction");
            for (std::size_t i = 0; i < sum.size(); ++i) {
                const double value = out.picture.plane(1)[i];
                sum[i] += value;
                squares[i] += value * value;
            }
        }
        for (const float n : {4.0f, 64.0f}) {
            double seen = 0.0, expected = 0.0;
            for (std::uint32_t y = 12; y < WallSize - 12; ++y) {
                for (std::uint32_t x = 12; x < WallSize - 12; ++x) {
                    if (few_or_many(x, y) != n) continue;
                    const std::size_t i = std::size_t{y} * WallSize + x;
                    seen += (squares[i] - sum[i] * sum[i] / Seeds) / (Seeds - 1);
                    expected += double(reduction.plane(0)[i]) / n;
                }
            }
            EXPECT_NEAR(seen / expected, 1.0, 0.15) << method << " " << n;
        }
    }
}

// The coverage of an antialiased pixel is that of its colour, whatever the counts of both sides are.
TEST(PixelCounts, AnAntialiasedEdgeIsTheMixtureOfItsSides) {
    const Inputs inputs = pixel_inputs(WallSize, WallSize, [](std::uint32_t x, std::uint32_t) {
        const float side = x < 24 ? 0.0f : x > 24 ? 1.0f : 0.5f;
        return PixelLight{
            .high = side, .variance = 1.0f, .headlight = 0.2f + 0.6f * side, .n = x < 24 ? 4.0f : 64.0f};
    });
    const Output out = run_filter(FilteredLight, inputs);
    for (std::uint32_t y = 0; y < WallSize; ++y) EXPECT_NEAR(out.picture.row(1, y)[24], 0.5f, 0.02f) << y;
}

// Holes take the mean of the samples around them.
TEST(PixelCounts, HolesAmongThemAreFilled) {
    const Inputs inputs = pixel_inputs(WallSize, WallSize, [](std::uint32_t x, std::uint32_t y) {
        if (noise(9, x, y) < 0.3f)
            return PixelLight{.depth = std::numeric_limits<float>::infinity(), .n = 0.0f};
        return PixelLight{.high = 1.0f, .variance = 1.0f, .n = few_or_many(x, y), .low = 2.0f};
    });
    const Output out = run_filter("pixel", inputs);
    for (const float value : out.picture.plane(1)) EXPECT_NEAR(value, 3.0f, 1e-4f);
}

// Nothing within three standard deviations: holes keep the nearest pixel's values.
TEST(PixelCounts, HolesFarFromSamplesAreFilled) {
    const Inputs inputs = pixel_inputs(WallSize, WallSize, [](std::uint32_t x, std::uint32_t y) {
        const bool hole = x > 10 && x < 30 && y > 10 && y < 30;
        return PixelLight{.high = 1.0f, .variance = 1.0f, .n = hole ? 0.0f : few_or_many(x, y)};
    });
    const Output out = run_filter("pixel:adaptive=off,sigma_s=0.5", inputs);
    for (const float value : out.picture.plane(1)) EXPECT_NEAR(value, 1.0f, 1e-4f);
}

}  // namespace
}  // namespace tessera::filter
