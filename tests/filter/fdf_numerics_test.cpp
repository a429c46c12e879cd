// Error reduction of the feature distance filter on "SYN-1" of the notes: shadows on textures, exact
// features.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "master/filter/fdf/nl_means.h"
#include "mediator/base/random.h"
#include "tests/filter/synthetic.h"

namespace tessera::filter {
namespace {

using frame::Channel;

constexpr std::uint32_t FdfWidth = 192, FdfHeight = 192;
constexpr frame::ChannelSet FdfChannels{Channel::Radiance, Channel::Albedo, Channel::Normal, Channel::Depth,
                                        Channel::ShadingFeature};

// Statistics of n samples that find the light or not, without drawing each.
Inputs shadows(std::uint32_t n, std::uint64_t seed = 1) {
    Inputs inputs = synthetic_inputs(
        FdfWidth, FdfHeight, 1,
        [](auto x, auto y, auto i) { return shadowed_texture(FdfWidth, FdfHeight, x, y, i); }, FdfChannels);
    const Planes truth = shadowed_texture_truth(FdfWidth, FdfHeight);
    std::mt19937_64 random(seed * 10007 + n);
    for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
        const double light = truth.plane(0)[i] / inputs.mean(Channel::Albedo).plane(0)[i];
        const double rate = std::binomial_distribution<std::uint32_t>(n, light)(random) / double(n);
        const double variance = rate * (1.0 - rate) / (n - 1.0);
        const auto set = [&](Channel channel, std::uint32_t c, double albedo) {
            const auto index = static_cast<std::size_t>(channel);
            inputs.means[index].plane(c)[i] = static_cast<float>(rate * albedo);
            inputs.variances[index].plane(c)[i] = static_cast<float>(variance * albedo * albedo);
        };
        inputs.counts.plane(0)[i] = static_cast<float>(n);
        set(Channel::ShadingFeature, 0, 1.0);
        for (std::uint32_t c = 0; c < 3; ++c) {
            set(Channel::Radiance, c, inputs.mean(Channel::Albedo).plane(c)[i]);
        }
    }
    return inputs;
}

double fdf_error(const Planes& picture, const Planes& truth) {
    double mean = 0.0, sum = 0.0;
    const std::size_t count = truth.values().size();
    for (const float t : truth.values()) mean += t / double(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double t = truth.values()[i], d = picture.values()[i] - t;
        sum += d * d / (t * t + 0.01 * mean * mean);
    }
    return sum / double(count);
}

struct Errors {
    double unfiltered, filtered;
    double gain() const { return unfiltered / filtered; }
};
Errors errors(const std::string& filter, std::uint32_t n) {
    const Inputs inputs = shadows(n);
    const Planes truth = shadowed_texture_truth(FdfWidth, FdfHeight);
    return {mean_squared_error(inputs.mean(Channel::Radiance), truth),
            mean_squared_error(run_filter(filter, inputs).picture, truth)};
}

TEST(FdfNumerics, TheVarianceOfTheShadingFallsWithTheSamples) {  // LT6
    std::map<std::uint64_t, double> variances;
    for (const std::uint64_t n : {4u, 64u}) {
        const Inputs inputs = synthetic_inputs(
            64, 64, n,
            [](auto x, auto y, auto i) {
                SyntheticSample sample = shadowed_texture(64, 64, x, y, i);
                sample.shading = CounterRandom(mix(i + 1), mix(y * 64 + x)).uniform() < 0.3f ? 1.0f : 0.0f;
                return sample;
            },
            FdfChannels);
        for (const float v : inputs.variance(Channel::ShadingFeature).values()) variances[n] += v / 4096.0;
    }
    EXPECT_NEAR(variances[4] * 4.0, 0.21, 0.01);
    EXPECT_NEAR(variances[64] * 64.0, 0.21, 0.01);
}

TEST(FdfNumerics, ThesisWeightOfEqualPixelsIsOneOverRootThree) {  // LT7
    // Pairs of pixels, each alone between holes: out = (a + w b) / (1 + w).
    constexpr std::uint32_t Pairs = 40000;
    std::mt19937_64 random(2);
    std::normal_distribution<double> normal;
    for (const double apart : {0.0, 1.0, 2.0}) {  // in standard deviations
        Planes values(2, 2 * Pairs, 1), variances(2, 2 * Pairs, 1), classes(2, 2 * Pairs, 1),
            out(2, 2 * Pairs, 1);
        for (std::uint32_t y = 0; y < 2 * Pairs; y += 2) {
            for (std::uint32_t x = 0; x < 2; ++x) {
                values.row(0, y)[x] = static_cast<float>(5.0 + 0.1 * normal(random) + 0.1 * apart * x);
                variances.row(0, y)[x] = 0.01f;
                classes.row(0, y)[x] = static_cast<float>(PixelClass::Surface);
            }
        }
        tbb::task_arena arena(2);
        RunContext context{arena, {}};
        NlMeans filter;
        ASSERT_TRUE(filter.run(values, variances, classes, {.form = NlmForm::Thesis, .radius = 1, .patch = 0},
                               out, context));
        double sum = 0.0;
        for (std::uint32_t y = 0; y < 2 * Pairs; y += 2) {
            const double a = values.row(0, y)[0], b = values.row(0, y)[1], f = out.row(0, y)[0];
            sum += std::abs(a - b) < 1e-3 ? 1.0 : (f - a) / (b - f);
        }
        EXPECT_NEAR(sum / Pairs, std::exp(-apart * apart / 6.0) / std::sqrt(3.0), 0.01) << apart;
    }
}

TEST(FdfNumerics, TheShadingFeatureMatters) {  // LT14
    for (const std::uint32_t n : {16u, 64u, 256u}) {
        EXPECT_GT(errors("fdf:blend=off,s_max=1000000", n).filtered,
                  2.0 * errors("fdf:blend=off", n).filtered);
    }
}

TEST(FdfNumerics, ThePrefilterMatters) {  // LT15
    for (const std::uint32_t n : {64u, 256u}) {
        EXPECT_LT(errors("fdf:blend=off", n).filtered, errors("fdf:blend=off,prefilter=off", n).filtered);
    }
}

TEST(FdfNumerics, TheStandardPrefilterIsBetterThanTheThesis) {
    for (const std::uint32_t n : {4u, 16u, 64u, 256u}) {
        EXPECT_LT(errors("fdf:blend=off", n).filtered, errors("fdf:blend=off,nlm=thesis", n).filtered) << n;
    }
}

TEST(FdfNumerics, AtLeastThreefoldAtFewSamplesAndLessWithMore) {  // LT17, LT18, LT19, LT20
    for (const std::string form : {"standard", "thesis"}) {
        double gain = INFINITY, error = INFINITY;
        for (const std::uint32_t n : {16u, 64u, 256u, 1024u}) {
            const Errors now = errors("fdf:blend=off,nlm=" + form, n);
            EXPECT_LT(now.gain(), gain) << form << n;
            EXPECT_LT(now.filtered, error) << form << n;
            gain = now.gain();
            error = now.filtered;
        }
        EXPECT_GT(errors("fdf:nlm=" + form, 4).gain(), 3.0);
        EXPECT_GT(errors("fdf:nlm=" + form, 16).gain(), 3.0);
    }
    EXPECT_LT(errors("fdf", 16).filtered, errors("fdf", 64).unfiltered);  // the error of 4 times the samples
}

TEST(FdfNumerics, OneSampleHasTheVarianceOfItsNeighbourhood) {
    // Within an object of one colour, light found by half of the samples. s_max makes the shading decide.
    const Inputs inputs = synthetic_inputs(
        64, 64, 1,
        [](auto x, auto y, auto i) {
            SyntheticSample sample;
            sample.shading = CounterRandom(mix(i + 7), mix(y * 64 + x)).uniform() < 0.5f ? 1.0f : 0.0f;
            sample.high = {sample.shading, sample.shading, sample.shading};
            return sample;
        },
        FdfChannels);
    Planes truth(64, 64, 3);
    std::ranges::fill(truth.values(), 0.5f);
    const double unfiltered = mean_squared_error(inputs.mean(Channel::Radiance), truth);
    EXPECT_LT(mean_squared_error(run_filter("fdf:s_max=0.3", inputs).picture, truth), 0.1 * unfiltered);
}

// Squares of 9 x 9 pixels, 0.2 % of the picture, with a thousand times the light; `deviation` is relative.
Inputs shadows_and_bright_square(std::uint32_t n, float deviation) {
    Inputs inputs = shadows(n);
    for (const Channel channel : {Channel::ShadingFeature, Channel::Radiance}) {
        const auto index = static_cast<std::size_t>(channel);
        for (std::uint32_t c = 0; c < inputs.means[index].components(); ++c) {
            for (std::uint32_t y = 4; y < 13; ++y) {
                for (std::uint32_t x = 4; x < 13; ++x) {
                    inputs.means[index].row(c, y)[x] = 1000.0f;
                    inputs.variances[index].row(c, y)[x] = 1e6f * deviation * deviation;
                }
            }
        }
    }
    return inputs;
}

// Largest difference out of reach of the square.
double difference_elsewhere(const Inputs& a, const Inputs& b) {
    const Planes one = run_filter("fdf:blend=off", a).picture, two = run_filter("fdf:blend=off", b).picture;
    double largest = 0.0;
    for (std::uint32_t y = 48; y < FdfHeight; ++y) {
        for (std::uint32_t x = 0; x < FdfWidth; ++x) {
            largest = std::max(largest, std::abs(double(one.row(1, y)[x]) - double(two.row(1, y)[x])));
        }
    }
    return largest;
}

// The emission of a lamp is no measure for differences of shading. What only some samples found is.
TEST(FdfNumerics, ALampDoesNotBlurShadowsElsewhere) {
    EXPECT_LT(difference_elsewhere(shadows(16), shadows_and_bright_square(16, 0.0f)), 0.002);
    EXPECT_GT(difference_elsewhere(shadows(16), shadows_and_bright_square(16, 1.0f)), 0.02);
}

TEST(FdfNumerics, NeverWorseThanUnfiltered) {  // L36
    const Planes truth = shadowed_texture_truth(FdfWidth, FdfHeight);
    for (std::uint32_t n = 4; n <= 4096; n *= 4) {
        const Inputs inputs = shadows(n);
        const double unfiltered = fdf_error(inputs.mean(Channel::Radiance), truth);
        EXPECT_LE(fdf_error(run_filter("fdf", inputs).picture, truth), 1.05 * unfiltered) << n;
    }
    const Inputs inputs = shadows(65536);
    const double unfiltered = fdf_error(inputs.mean(Channel::Radiance), truth);
    EXPECT_GT(fdf_error(run_filter("fdf:blend=off", inputs).picture, truth), 2.0 * unfiltered);
    EXPECT_LE(fdf_error(run_filter("fdf", inputs).picture, truth), 1.05 * unfiltered);
}

TEST(FdfNumerics, CountsMayDifferBetweenPixels) {  // L13
    // The left half has 4 samples, the right half 256: as if each were filtered in a separate picture.
    Inputs mixed = shadows(256);
    const Inputs few = shadows(4);
    const auto take_left = [&](Planes& to, const Planes& from) {
        for (std::uint32_t c = 0; c < to.components(); ++c) {
            for (std::uint32_t y = 0; y < FdfHeight; ++y)
                std::copy_n(from.row(c, y), FdfWidth / 2, to.row(c, y));
        }
    };
    take_left(mixed.counts, few.counts);
    for (const Channel channel : {Channel::Radiance, Channel::ShadingFeature}) {
        const auto index = static_cast<std::size_t>(channel);
        take_left(mixed.means[index], few.means[index]);
        take_left(mixed.variances[index], few.variances[index]);
    }
    const Planes truth = shadowed_texture_truth(FdfWidth, FdfHeight);
    const auto error = [&](const Planes& picture, std::uint32_t first) {
        double sum = 0.0;
        for (std::uint32_t c = 0; c < 3; ++c) {
            for (std::uint32_t y = 0; y < FdfHeight; ++y) {
                for (std::uint32_t x = first; x < first + FdfWidth / 2; ++x) {
                    sum += std::pow(double(picture.row(c, y)[x]) - truth.row(c, y)[x], 2.0);
                }
            }
        }
        return sum;
    };
    const Planes together = run_filter("fdf", mixed).picture;
    EXPECT_LT(error(together, 0), 1.1 * error(run_filter("fdf", few).picture, 0));
    EXPECT_LT(error(together, FdfWidth / 2),
              1.15 * error(run_filter("fdf", shadows(256)).picture, FdfWidth / 2));
}

}  // namespace
}  // namespace tessera::filter
