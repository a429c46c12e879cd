#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "master/filter/catalog.h"
#include "master/filter/moderated_variance.h"
#include "master/filter/noise_correlation.h"
#include "master/filter/student.h"
#include "mediator/base/random.h"
#include "mediator/filter/choice.h"
#include "tests/filter/synthetic.h"

namespace tessera::filter {
namespace {

constexpr frame::ChannelSet Color{frame::Channel::Radiance};

SyntheticSample grey(double value) {
    SyntheticSample s;
    s.high.fill(static_cast<float>(value));
    return s;
}

// Standard normal, from two uniform numbers (Box and Muller).
double normal(CounterRandom& random) {
    const double u = 1.0 - random.uniform(), v = random.uniform();
    return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * 3.14159265358979 * v);
}

TEST(StudentQuantile, IsTheTablesOfTextbooks) {
    EXPECT_NEAR(student_quantile(0.95, 1), 12.7062, 1e-4);
    EXPECT_NEAR(student_quantile(0.95, 2), 4.30265, 1e-5);
    EXPECT_NEAR(student_quantile(0.95, 10), 2.22814, 1e-5);
    EXPECT_NEAR(student_quantile(0.99, 3), 5.84091, 1e-5);
    EXPECT_NEAR(student_quantile(0.99, 30), 2.75000, 1e-5);
    EXPECT_NEAR(student_quantile(0.95, 1e9), 1.959964, 1e-5);
}

TEST(StudentQuantile, ItsTableOfSquaresIsCloseEverywhere) {
    StudentSquares squares;
    for (const double confidence : {0.5, 0.95, 0.995, 0.9999}) {
        squares.prepare(confidence);
        for (double dof = 1.0; dof < 1e6; dof *= 1.13) {
            const double t = student_quantile(confidence, dof);
            EXPECT_NEAR(squares(static_cast<float>(dof)), t * t, 1e-3 * t * t) << confidence << ' ' << dof;
        }
    }
}

// Two pixels of n normal samples each; how often the average of either includes the other.
struct Joined {
    double rate = 0.0;
    bool always_both = true;
};
Joined joined(std::uint64_t n, double mean_step, double second_deviation, const std::string& options) {
    constexpr int Trials = 3000;
    const Choice choice = parse_choice("statmc:blend=off,radius=1,sigma=100," + options, catalog()).value();
    const auto filter = choice.entry->make(2, 1);
    tbb::task_arena arena(1);
    Output out;
    int count = 0;
    Joined result;
    for (int trial = 0; trial < Trials; ++trial) {
        CounterRandom random(static_cast<std::uint64_t>(trial), n);
        const Inputs inputs = synthetic_inputs(
            2, 1, n,
            [&](auto x, auto, auto) {
                return grey(100.0 + x * mean_step + (x == 0 ? 1.0 : second_deviation) * normal(random));
            },
            Color);
        filter->run(inputs, choice.values, out, {arena, {}});
        const auto moved = [&](std::size_t x) {
            return std::abs(out.picture.plane(0)[x] - inputs.color(0)[x]) > 1e-4f;
        };
        count += moved(0);
        result.always_both = result.always_both && moved(0) == moved(1);
    }
    result.rate = static_cast<double>(count) / Trials;
    return result;
}

TEST(StatMc, EqualMeansAreJoinedAtTheStatedRate) {
    for (const std::uint64_t n : {4, 16, 64}) {
        EXPECT_NEAR(joined(n, 0.0, 1.0, "confidence=0.95,pooled=0").rate, 0.95, 0.02) << n;
        EXPECT_NEAR(joined(n, 0.0, 4.0, "confidence=0.95,pooled=0").rate, 0.95, 0.02) << n;
        EXPECT_NEAR(joined(n, 0.0, 1.0, "confidence=0.8,pooled=0").rate, 0.8, 0.03) << n;
    }
}

TEST(StatMc, DifferentMeansSeparateWithEnoughSamples) {
    // The difference is 1 standard deviation of a sample; sqrt(n / 2) standard errors.
    EXPECT_GT(joined(4, 1.0, 1.0, "confidence=0.95,pooled=0").rate, 0.6);
    EXPECT_LT(joined(64, 1.0, 1.0, "confidence=0.95,pooled=0").rate, 0.01);
    EXPECT_LT(joined(256, 1.0, 1.0, "confidence=0.995").rate, 0.001);
}

// How often two pixels of 64 log-normal samples, one 4.5 times as bright, are joined.
double joined_although_skewed(const std::string& transform) {
    constexpr int Trials = 400;
    int count = 0;
    for (int trial = 0; trial < Trials; ++trial) {
        CounterRandom random(static_cast<std::uint64_t>(trial), 11);
        const Inputs inputs = synthetic_inputs(
            2, 1, 64,
            [&](auto x, auto, auto) { return grey(std::exp(1.5 * normal(random) - (x == 0 ? 0.0 : 1.5))); },
            {frame::Channel::Radiance, frame::Channel::Root});
        const Output out =
            run_filter("statmc:blend=off,radius=1,sigma=100,pooled=0,transform=" + transform, inputs);
        count += std::abs(out.picture.plane(0)[0] - inputs.color(0)[0]) > 1e-4f ? 1 : 0;
    }
    return static_cast<double>(count) / Trials;
}

TEST(StatMc, RootsOfSkewedSamplesSeparate) {
    EXPECT_GT(joined_although_skewed("none"), 0.35);
    EXPECT_LT(joined_although_skewed("root"), 0.1);
}

TEST(StatMc, ReadsRootIfItComparesRoots) {
    const auto channels = [](const char* text) { return parse_choice(text, catalog()).value().channels(); };
    EXPECT_TRUE(channels("statmc").contains(frame::Channel::Root));
    EXPECT_FALSE(channels("statmc:transform=none").contains(frame::Channel::Root));
    const auto sampler = [](auto x, auto, auto i) { return grey(1.0 + 0.1 * double((x + i) % 3)); };
    const Inputs without = synthetic_inputs(12, 12, 4, sampler, Color);
    const Choice choice = parse_choice("statmc", catalog()).value();
    tbb::task_arena arena(1);
    Output out;
    EXPECT_EQ(choice.entry->make(12, 12)->run(without, choice.values, out, {arena, {}}).notes.size(), 1u);
    const Output none = run_filter("statmc:transform=none", without);
    EXPECT_TRUE(std::ranges::equal(out.picture.values(), none.picture.values()));
}

TEST(StatMc, MembershipIsSymmetric) {
    EXPECT_TRUE(joined(6, 1.5, 3.0, "confidence=0.8,pooled=0").always_both);
    EXPECT_TRUE(joined(6, 1.5, 3.0, "confidence=0.8").always_both);
}

TEST(StatMc, EqualSamplesAreNotExactSamples) {
    // Half of the samples find the light. With 2 in each pixel every fourth is all black and every fourth all
    // white, both of variance 0; they must be averaged all the same.
    const Inputs inputs = synthetic_inputs(
        48, 48, 2,
        [](auto x, auto y, auto i) {
            CounterRandom random(mix(5), mix((std::uint64_t{y} << 32 | x) ^ mix(i)));
            return grey(random.uniform() < 0.5);
        },
        Color);
    const Output own = run_filter("statmc:blend=off,pooled=0", inputs);
    const Output moderated = run_filter("statmc:blend=off", inputs);
    Planes truth(48, 48, 3);
    std::ranges::fill(truth.values(), 0.5f);
    const auto [least, most] = std::ranges::minmax(moderated.picture.plane(0));
    EXPECT_GT(least, 0.25f);
    EXPECT_LT(most, 0.75f);
    // The error without moderated variances.
    EXPECT_GT(mean_squared_error(own.picture, truth), 2.0 * mean_squared_error(moderated.picture, truth));
}

TEST(StatMc, TheNeighbourhoodsVarianceVanishesWithTheSamples) {
    // One pixel without noise in a noisy square.
    for (const std::uint64_t n : {1, 2, 8, 128}) {
        const Inputs inputs = synthetic_inputs(
            9, 9, n,
            [](auto x, auto y, auto i) {
                CounterRandom random(mix(6), mix((std::uint64_t{y} << 32 | x) ^ mix(i)));
                return x == 4 && y == 4 ? grey(0.5) : grey(random.uniform());
            },
            Color);
        ModeratedVariance moderated;
        tbb::task_arena arena(1);
        RunContext context{arena, {}};
        ASSERT_TRUE(moderated.run(inputs, 4.0f, 3, context));
        const double expected = 1.0 / 12.0 / static_cast<double>(n) * 4.0 / (static_cast<double>(n) + 3.0);
        const float found = moderated.variance().row(0, 4)[4];
        EXPECT_NEAR(found, expected, 0.35 * expected) << n;  // 48 pixels: its own error
        EXPECT_EQ(moderated.dof().row(0, 4)[4], static_cast<float>(n) + 3.0f);
    }
}

// A vertical edge that no feature shows.
Inputs edge(std::uint64_t n, double dark, double bright) {
    return synthetic_inputs(
        40, 24, n,
        [=](auto x, auto y, auto i) {
            CounterRandom random(mix(7), mix((std::uint64_t{y} << 32 | x) ^ mix(i)));
            return grey((x < 20 ? dark : bright) * 2.0 * random.uniform());
        },
        Color);
}

TEST(StatMc, KeepsAnEdgeThatNoFeatureShows) {
    const Inputs inputs = edge(256, 1.0, 2.0);
    const Output out = run_filter("statmc", inputs);
    for (std::uint32_t y = 0; y < 24; ++y) {
        EXPECT_NEAR(out.picture.row(0, y)[19], 1.0f, 0.05f);
        EXPECT_NEAR(out.picture.row(0, y)[20], 2.0f, 0.1f);
    }
}

TEST(StatMc, KeepsFeatureEdgesAtFewSamples) {
    Inputs inputs = synthetic_inputs(40, 24, 4, [](auto x, auto y, auto i) {
        CounterRandom random(mix(8), mix((std::uint64_t{y} << 32 | x) ^ mix(i)));
        SyntheticSample s = grey((x < 20 ? 0.8 : 1.2) * 2.0 * random.uniform());
        s.normal = x < 20 ? std::array{0.0f, 0.0f, 1.0f} : std::array{1.0f, 0.0f, 0.0f};
        return s;
    });
    const Output out = run_filter("statmc:blend=off", inputs);
    double left = 0.0, right = 0.0;
    for (std::uint32_t y = 0; y < 24; ++y) {
        left += out.picture.row(0, y)[19] / 24.0;
        right += out.picture.row(0, y)[20] / 24.0;
    }
    EXPECT_NEAR(left, 0.8, 0.1);
    EXPECT_NEAR(right, 1.2, 0.1);
}

// Between two surfaces of the same light, a column of pixels sees both.
double error_at_outline(std::uint64_t n, const std::string& options) {
    const Inputs inputs = synthetic_inputs(41, 64, n, [](auto x, auto y, auto i) {
        CounterRandom random(mix(12), mix((std::uint64_t{y} << 32 | x) ^ mix(i)));
        const bool first = x == 20 ? random.uniform() < 0.5 : x < 20;
        SyntheticSample s = grey(2.0 * random.uniform());
        s.albedo = first ? std::array{0.8f, 0.8f, 0.8f} : std::array{0.2f, 0.2f, 0.2f};
        s.normal = first ? std::array{0.0f, 0.0f, 1.0f} : std::array{1.0f, 0.0f, 0.0f};
        return s;
    });
    const Output out = run_filter("statmc:blend=off," + options, inputs);
    double sum = 0.0;
    for (std::uint32_t y = 0; y < 64; ++y) sum += std::pow(out.picture.row(0, y)[20] - 1.0, 2) / 64.0;
    return sum;
}

TEST(StatMc, NoisyFeaturesDoNotLeaveSpecks) {
    for (const std::uint64_t n : {4, 16}) {
        EXPECT_LT(error_at_outline(n, "feature_noise=2"), 0.5 * error_at_outline(n, "feature_noise=0")) << n;
    }
}

TEST(NoiseCorrelation, IsThatOfTheSamples) {
    // Radiance is twice the low part, or independent of it.
    for (const bool same : {true, false}) {
        Inputs inputs =
            synthetic_inputs(40, 30, 4,
                             [&](auto x, auto y, auto i) {
                                 CounterRandom random(mix(13), mix((std::uint64_t{y} << 32 | x) ^ mix(i)));
                                 SyntheticSample s;
                                 const auto low = static_cast<float>(random.uniform()),
                                            other = static_cast<float>(random.uniform());
                                 s.low.fill(x == 11 ? std::nanf("") : low);
                                 s.high.fill(same ? low : other - low);
                                 return s;
                             },
                             {frame::Channel::Radiance, frame::Channel::LowVariance});
        NoiseCorrelation correlation;
        tbb::task_arena arena(1);
        RunContext context{arena, {}};
        ASSERT_TRUE(
            correlation.run(inputs, frame::Channel::Radiance, frame::Channel::LowVariance, 3, context));
        const auto [least, most] = std::ranges::minmax(correlation.squared().plane(0));
        EXPECT_GE(least, same ? 0.999f : 0.0f);
        EXPECT_LE(most, same ? 1.0f : 0.6f);
        double mean = 0.0;
        for (const float value : correlation.squared().plane(0)) mean += value / (40.0 * 30.0);
        EXPECT_NEAR(mean, same ? 1.0 : 0.04, 0.04);
    }
}

TEST(StatMc, ManySamplesWeighMoreThanFew) {
    // Right: 1 sample in each pixel; left: 64. Pixels with one sample must not spread their noise.
    const auto sampler = [](auto x, auto y, auto i) {
        CounterRandom random(mix(9), mix((std::uint64_t{y} << 32 | x) ^ mix(i)));
        SyntheticSample s = grey(2.0 * random.uniform());
        if (x >= 10 && i > 0) s.high[0] = std::nanf("");  // rejected
        return s;
    };
    const Inputs inputs = synthetic_inputs(20, 20, 64, sampler, Color);
    ASSERT_EQ(inputs.counts.row(0, 0)[19], 1.0f);
    const Output out = run_filter("statmc:blend=off", inputs);
    for (std::uint32_t y = 0; y < 20; ++y) {
        EXPECT_NEAR(out.picture.row(0, y)[9], 1.0f, 0.05f);   // 0.072 is one pixel's own error
        EXPECT_NEAR(out.picture.row(0, y)[10], 1.0f, 0.15f);  // 0.58 is its own
    }
}

TEST(StatMc, FillsHolesFromNeighbours) {
    const Inputs inputs = synthetic_inputs(
        20, 20, 8,
        [](auto x, auto y, auto) { return x / 5 == 1 && y / 5 == 2 ? grey(std::nan("")) : grey(0.25); },
        Color);
    ASSERT_EQ(inputs.counts.row(0, 12)[7], 0.0f);
    const Output out = run_filter("statmc", inputs);
    for (const float value : out.picture.plane(0)) EXPECT_NEAR(value, 0.25f, 1e-6f);
}

}  // namespace
}  // namespace tessera::filter
