// The closed forms of the pixel filter: blend factor, widths, schedule (Schwenk 3.3.3, 3.3.5, 3.6, App. 3.A).
#include <gtest/gtest.h>

#include <vector>

#include "master/filter/pixel/blend_factor.h"
#include "master/filter/pixel/schedule.h"
#include "master/filter/pixel/widths.h"

namespace tessera::filter::pixel {
namespace {

struct Vector {
    float u, f, t;
    double s;
};

TEST(BlendFactor, GivesTheGoldenVectors) {
    for (const Vector& v : {Vector{2.0f, 0.2f, 1.0f, 0.700746}, Vector{5.0f, 0.5f, 1.0f, 0.405827},
                            Vector{10.0f, 1.0f, 1.0f, 0.181818}, Vector{11.01f, 1.101f, 1.0f, 0.0},
                            Vector{0.5f, 0.01f, 0.1f, 0.440149}, Vector{4.0f, 0.05f, 0.01f, 0.0},
                            Vector{1.0f, 0.001f, 0.01f, 0.095825}, Vector{2.0f, 2.0f, 1.0f, 0.5}}) {
        EXPECT_NEAR(blend_factor(v.u, v.f, v.t), v.s, 1e-6) << v.u << " " << v.f << " " << v.t;
    }
    // The discriminant is 0 except for rounding.
    EXPECT_NEAR(blend_factor(11.0f, 1.1f, 1.0f), 1.0 / 11.0, 1e-3);
}

TEST(BlendFactor, MeetsTheThresholdExactlyWhereItIsPossible) {
    for (double u = 1.01; u < 40.0; u *= 1.07) {
        for (const double r : {0.001, 0.01, 0.1, 0.5}) {
            const double f = r * u, t = 1.0;
            if (t * u + t * f - u * f < 1e-3) continue;
            const double s = blend_factor(float(u), float(f), float(t));
            EXPECT_NEAR(s * s * u + (1 - s) * (1 - s) * f, t, 1e-6 * (1.0 + u)) << u << " " << f;
            const double a = central_weight(float(r));
            const double c = blend_factor(float(u), float(f), float(t), float(a));
            if (f - a * u < 0 && f > t) continue;
            EXPECT_NEAR(c * c * u + (1 - c) * (1 - c) * f + 2 * c * (1 - c) * a * u, t, 1e-5 * (1.0 + u));
        }
    }
}

TEST(BlendFactor, HasThreeCases) {
    EXPECT_EQ(blend_factor(0.0f, 0.0f, 0.01f), 1.0f);
    EXPECT_EQ(blend_factor(0.0f, 0.0f, 0.0f), 1.0f);
    EXPECT_EQ(blend_factor(1.0f, 0.1f, 0.0f), 0.0f);
    EXPECT_EQ(blend_factor(1.0f, 0.0f, 0.0f), 0.0f);
    EXPECT_EQ(blend_factor(1.0f, 0.1f, 1.0f), 1.0f);
    EXPECT_EQ(blend_factor(0.99f, 0.5f, 1.0f), 1.0f);
    EXPECT_EQ(blend_factor(100.0f, 10.0f, 1.0f), 0.0f);
    EXPECT_EQ(blend_factor(1.0f, 0.1f, 0.0f, 0.2f), 0.0f);
    EXPECT_EQ(blend_factor(0.5f, 0.1f, 1.0f, 0.2f), 1.0f);
}

TEST(BlendFactor, IsContinuousWhereTheFilterBecomesUnnecessary) {
    EXPECT_NEAR(blend_factor(1.0001f, 0.01f, 1.0f), 1.0, 1e-3);
    EXPECT_NEAR(blend_factor(1.0001f, 0.01f, 1.0f, 0.02f), 1.0, 1e-3);
}

TEST(BlendFactor, FallsStrictlyWithTheVariance) {
    for (const float r : {0.001f, 0.05f, 0.3f}) {
        float last = 1.0f;
        for (float u = 1.01f; u < 0.99f * (1.0f + r) / r; u *= 1.03f) {
            const float s = blend_factor(u, r * u, 1.0f);
            ASSERT_LT(s, last) << u;
            last = s;
        }
    }
}

// The formula in double, to differentiate it.
double root_of(double u, double f, double t) {
    return (f + std::sqrt(t * u + t * f - u * f)) / (u + f);
}

TEST(BlendFactor, HasTheSlopesOfTheAppendix) {
    const double t = 1.0, h = 1e-5;
    for (const double u : {1.5, 2.0, 5.0, 8.0}) {
        const double r = 0.05;
        EXPECT_NEAR(blend_factor(float(u), float(r * u), 1.0f), root_of(u, r * u, t), 1e-6);
        const double along = (root_of(u + h, r * (u + h), t) - root_of(u - h, r * (u - h), t)) / (2 * h);
        const double slope = -t / (2 * u * std::sqrt(u * (r * t - r * u + t)));  // 3.23
        EXPECT_NEAR(along / slope, 1.0, 1e-4);

        const double f = 0.3, q = std::sqrt(t * u + t * f - u * f);
        const double fixed = (root_of(u + h, f, t) - root_of(u - h, f, t)) / (2 * h);
        const double numerator = -2 * f * q + u * f - f * f - t * u - t * f;
        EXPECT_NEAR(fixed / (numerator / (2 * (u + f) * (u + f) * q)), 1.0, 1e-4);  // 3.24
        EXPECT_LT(numerator, -f * f);                                               // 3.25
        // And so does the implementation, within the precision of float.
        const double d = 0.02;
        const double seen =
            (blend_factor(float(u + d), float(f), 1.0f) - blend_factor(float(u - d), float(f), 1.0f)) /
            (2 * d);
        EXPECT_NEAR(seen / fixed, 1.0, 2e-3);
    }
}

TEST(BlendFactor, JumpsToZeroWhereEvenTheFilteredLightIsTooNoisy) {
    for (const float r : {0.05f, 1.0f / 9.0f, 0.5f, 1.0f}) {
        const float end = (1.0f + r) / r;  // u at point (b) for t = 1
        EXPECT_NEAR(blend_factor(end * 0.9999f, r * end * 0.9999f, 1.0f), r / (1.0f + r), 0.02);
        EXPECT_EQ(blend_factor(end * 1.0001f, r * end * 1.0001f, 1.0f), 0.0f);
    }
    const float end = 10.0f;
    const double exact = root_of(end, end / 9.0, 1.0 + 1e-9);
    EXPECT_NEAR(exact, 0.1, 1e-4);
}

TEST(BlendFactor, DoesNotJumpWithTheCovariance) {
    for (const float r : {0.001f, 0.02f, 0.2f, 0.7f, 0.99f}) {
        const float a = central_weight(r);
        float last = 1.0f;
        for (float u = 0.9f; u < 1e5f; u *= 1.0005f) {
            const float s = blend_factor(u, r * u, 1.0f, a);
            ASSERT_LT(std::abs(s - last), 0.05f) << "r " << r << ", u " << u;
            ASSERT_LE(s, last + 1e-4f);
            last = s;
        }
        EXPECT_EQ(last, 0.0f);
    }
}

TEST(BlendFactor, IsFiniteEverywhere) {
    const std::vector<float> values{0.0f, 1e-45f, 1e-38f, 1e-20f, 1e-3f, 1.0f, 1e4f, 1e18f, 3e38f};
    for (const float u : values) {
        for (const float r : {0.0f, 1e-4f, 0.5f, 1.0f}) {
            for (const float t : {0.0f, 1e-6f, 0.01f, 10.0f}) {
                for (const float s :
                     {blend_factor(u, r * u, t), blend_factor(u, r * u, t, central_weight(r))}) {
                    EXPECT_GE(s, 0.0f) << u << " " << r << " " << t;
                    EXPECT_LE(s, 1.0f) << u << " " << r << " " << t;
                }
            }
        }
        for (const float background : values) {
            EXPECT_TRUE(std::isfinite(perceived_variance(u, background))) << u << " " << background;
        }
    }
    EXPECT_FLOAT_EQ(perceived_variance(0.04f, 2.0f), 0.01f);
}

TEST(CentralWeight, IsThatOfGaussiansAndOfASinglePixel) {
    for (const double sigma : {2.0, 4.0, 8.0}) {
        const double r = 1.0 / (4.0 * M_PI * sigma * sigma), a = 1.0 / (2.0 * M_PI * sigma * sigma);
        EXPECT_NEAR(central_weight(float(r)) / a, 1.0, 2.0 * r);
    }
    EXPECT_EQ(central_weight(1.0f), 1.0f);
}

TEST(SpikeClamp, StaysWithinTheFactor) {
    EXPECT_EQ(clamp_spike(100.0f, 1.0f, 2.0f), 2.0f);
    EXPECT_EQ(clamp_spike(0.0f, 1.0f, 2.0f), 0.5f);
    EXPECT_EQ(clamp_spike(1.3f, 1.0f, 2.0f), 1.3f);
}

TEST(IterationSigma, SquaresSumToTheWhole) {
    for (const double sigma : {0.7, 4.0, 8.0, 30.0}) {
        for (int n = 1; n <= 6; ++n) {
            double sum = 0.0;
            for (int k = 1; k <= n; ++k) sum += std::pow(iteration_sigma(sigma, k, n), 2);
            EXPECT_NEAR(sum / (sigma * sigma), 1.0, 1e-12);
        }
    }
    EXPECT_NEAR(iteration_sigma(8.0, 1, 3), 6.983, 1e-3);
    EXPECT_NEAR(iteration_sigma(8.0, 2, 3), 3.491, 1e-3);
    EXPECT_NEAR(iteration_sigma(8.0, 3, 3), 1.746, 1e-3);
}

TEST(ReductionRatio, IsThatOfGaussiansWhenWide) {
    EXPECT_NEAR(reduction_ratio(8.0, 3), 48.0 / 63.0, 0.01);
    EXPECT_NEAR(reduction_ratio(16.0, 2), 12.0 / 15.0, 0.01);
    EXPECT_NEAR(reduction_ratio(8.0, 1), 1.0, 1e-12);
    EXPECT_NEAR(reduction_ratio(0.3, 3), 1.0, 1e-12);
}

TEST(AdaptiveSigma, IsTheBoxThatMeetsTheThresholdNearTheGuideLine) {
    // u / (2 e + 1)^2 = t with e = 4 pixels.
    EXPECT_NEAR(adaptive_sigma(81.0f * 0.01f, 0.01f, 1.0f, 8.0f, 4.0f), 6.0, 1e-4);
    EXPECT_NEAR(adaptive_sigma(9.0f * 0.01f, 0.01f, 4.0f, 8.0f, 4.0f), 1.5, 1e-5);
    for (const float n : {1.0f, 4.0f, 64.0f, 4096.0f}) {
        const float guide = 8.0f / std::sqrt(n);
        for (const float u : {0.0f, 1e-4f, 0.01f, 1.0f, 1e6f}) {
            const float sigma = adaptive_sigma(u, 0.01f, n, 8.0f, 4.0f);
            EXPECT_GE(sigma, guide / 4.0f);
            EXPECT_LE(sigma, guide * 4.0f);
        }
        EXPECT_FLOAT_EQ(adaptive_sigma(0.005f, 0.01f, n, 8.0f, 4.0f), guide / 4.0f);
    }
}

TEST(FilterDue, IsAtPowersOfTwoFromFourOn) {
    std::vector<std::uint64_t> passes;
    std::uint64_t last = 0;
    for (std::uint64_t n = 1; n <= 100; ++n) {
        if (!filter_due(n, last)) continue;
        passes.push_back(n);
        last = n;
    }
    EXPECT_EQ(passes, (std::vector<std::uint64_t>{4, 8, 16, 32, 64}));
    EXPECT_TRUE(filter_due(100, 20));  // several steps were missed: one pass
    EXPECT_FALSE(filter_due(100, 64));
    EXPECT_FALSE(filter_due(100, 70));
}

TEST(MedianCount, IsThatOfThePictureOrOfAGridOverIt) {
    EXPECT_EQ(median_count({}), 0u);
    EXPECT_EQ(median_count(std::vector<float>{7.0f}), 7u);
    EXPECT_EQ(median_count(std::vector<float>{1.0f, 9.0f, 4.0f}), 4u);
    std::vector<float> counts(1280 * 720, 16.0f);
    for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = i % 1280 < 512 ? 8.0f : 16.0f;
    EXPECT_EQ(median_count(counts), 16u);
    for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = i % 1280 < 768 ? 8.0f : 16.0f;
    EXPECT_EQ(median_count(counts), 8u);
}

}  // namespace
}  // namespace tessera::filter::pixel
