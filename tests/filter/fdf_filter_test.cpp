// The feature distance filter against direct sums over windows, and at its limits.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "master/filter/fdf/feature_bilateral.h"
#include "master/filter/fdf/nl_means.h"
#include "tests/filter/synthetic.h"

namespace tessera::filter {
namespace {

using frame::Channel;

constexpr float Hole = 0.0f, Surface = 1.0f, Background = 2.0f;

Planes& mean(Inputs& inputs, Channel channel) {
    return inputs.means[static_cast<std::size_t>(channel)];
}
Planes& variance(Inputs& inputs, Channel channel) {
    return inputs.variances[static_cast<std::size_t>(channel)];
}

Planes filled(std::uint32_t width, std::uint32_t height, std::uint32_t components, float value) {
    Planes planes(width, height, components);
    std::ranges::fill(planes.values(), value);
    return planes;
}

// Constant inputs: radiance 0.5, albedo 0.5, normal z, shading 1, known exactly from 4 samples.
Inputs plain(std::uint32_t width, std::uint32_t height, bool with_alpha = false) {
    Inputs inputs;
    inputs.width = width;
    inputs.height = height;
    inputs.counts = filled(width, height, 1, 4.0f);
    mean(inputs, Channel::Radiance) = filled(width, height, 3, 0.5f);
    variance(inputs, Channel::Radiance) = filled(width, height, 3, 0.0f);
    mean(inputs, Channel::Albedo) = filled(width, height, 3, 0.5f);
    mean(inputs, Channel::Normal) = filled(width, height, 3, 0.0f);
    std::ranges::fill(mean(inputs, Channel::Normal).plane(2), 1.0f);
    mean(inputs, Channel::Depth) = filled(width, height, 1, 1.0f);
    mean(inputs, Channel::ShadingFeature) = filled(width, height, 1, 1.0f);
    variance(inputs, Channel::ShadingFeature) = filled(width, height, 1, 0.0f);
    if (with_alpha) mean(inputs, Channel::Alpha) = filled(width, height, 1, 1.0f);
    return inputs;
}

float pair_distance(const NlmSettings& settings, float va, float vb, float variance_a, float variance_b) {
    const float d2 = (va - vb) * (va - vb), both = variance_a + variance_b;
    if (settings.form == NlmForm::Thesis) return std::exp(-d2 / (NlmEpsilon + both));
    return (d2 - variance_a - std::min(variance_a, variance_b)) /
           (NlmEpsilon + settings.k * settings.k * both);
}

// E-L4 ... E-L7 as published.
float direct_nl_means(const Planes& values, const Planes& variances, const Planes& classes,
                      const NlmSettings& settings, int x, int y) {
    const int width = static_cast<int>(values.width()), height = static_cast<int>(values.height());
    const int r = static_cast<int>(settings.radius), s = static_cast<int>(settings.patch);
    const auto inside = [&](int i, int j) { return i >= 0 && j >= 0 && i < width && j < height; };
    const auto at = [&](const Planes& planes, int i, int j) {
        return planes.row(0, static_cast<std::uint32_t>(j))[i];
    };
    const double unknown = settings.form == NlmForm::Thesis ? 1.0 / std::sqrt(3.0) : 0.0;
    double sum = 0.0, weights = 0.0;
    for (int j = y - r; j <= y + r; ++j) {
        for (int i = x - r; i <= x + r; ++i) {
            if (!inside(i, j) || at(classes, i, j) != at(classes, x, y)) continue;
            double d = 0.0;
            for (int dy = -s; dy <= s; ++dy) {
                for (int dx = -s; dx <= s; ++dx) {
                    const bool a_in = inside(x + dx, y + dy), b_in = inside(i + dx, j + dy);
                    const float a = a_in ? at(classes, x + dx, y + dy) : -1.0f;
                    const float b = b_in ? at(classes, i + dx, j + dy) : -1.0f;
                    if (a != b) {
                        d += unknown;
                    } else if (a < 0.0f) {
                        d += settings.form == NlmForm::Thesis ? 1.0 : 0.0;
                    } else {
                        d += pair_distance(settings, at(values, x + dx, y + dy), at(values, i + dx, j + dy),
                                           at(variances, x + dx, y + dy), at(variances, i + dx, j + dy));
                    }
                }
            }
            d /= (2 * s + 1) * (2 * s + 1);
            double w = settings.form == NlmForm::Thesis ? d : std::exp(-std::max(0.0, d));
            if (i == x && j == y) w = 1.0;
            sum += w * at(values, i, j);
            weights += w;
        }
    }
    return static_cast<float>(sum / weights);
}

struct ShadingCase {
    Planes values, variances, classes;
};

// Light and shadow with noise of known variance; a background, and some holes.
ShadingCase noisy_shading(std::uint32_t width, std::uint32_t height, std::uint64_t seed) {
    ShadingCase result{Planes(width, height, 1), Planes(width, height, 1), Planes(width, height, 1)};
    std::mt19937_64 random(seed);
    std::normal_distribution<float> normal;
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            const float sigma = x < width / 2 ? 0.1f : 0.3f, light = x + y < width ? 1.0f : 2.0f;
            result.values.row(0, y)[x] = light + sigma * normal(random);
            result.variances.row(0, y)[x] = sigma * sigma;
            result.classes.row(0, y)[x] = random() % 17 == 0 ? Hole : y < height / 4 ? Background : Surface;
        }
    }
    return result;
}

Planes nl_means(const ShadingCase& shading, const NlmSettings& settings) {
    Planes out(shading.values.width(), shading.values.height(), 1);
    tbb::task_arena arena(2);
    RunContext context{arena, {}};
    NlMeans filter;
    EXPECT_TRUE(filter.run(shading.values, shading.variances, shading.classes, settings, out, context));
    return out;
}

TEST(FdfNlMeans, BoxSumsEqualTheDirectSums) {  // LT9
    const ShadingCase shading = noisy_shading(83, 45, 3);
    for (const NlmSettings settings :
         {NlmSettings{}, NlmSettings{.form = NlmForm::Thesis},
          NlmSettings{.radius = 3, .patch = 0, .k = 1.0f}, NlmSettings{.radius = 2, .patch = 4},
          NlmSettings{.form = NlmForm::Thesis, .radius = 1, .patch = 3}}) {
        const Planes out = nl_means(shading, settings);
        for (std::uint32_t y = 0; y < 45; ++y) {
            for (std::uint32_t x = 0; x < 83; ++x) {
                if (shading.classes.row(0, y)[x] == Hole) continue;
                ASSERT_NEAR(out.row(0, y)[x],
                            direct_nl_means(shading.values, shading.variances, shading.classes, settings,
                                            static_cast<int>(x), static_cast<int>(y)),
                            1e-5)
                    << x << " " << y << " patch " << settings.patch;
            }
        }
    }
}

TEST(FdfNlMeans, WithoutNoiseNothingCrossesAnEdge) {  // LT8
    ShadingCase shading{Planes(40, 40, 1), Planes(40, 40, 1), filled(40, 40, 1, Surface)};
    for (std::uint32_t y = 0; y < 40; ++y) {
        for (std::uint32_t x = 0; x < 40; ++x) shading.values.row(0, y)[x] = x < 19 ? 1.0f : 1.01f;
    }
    const Planes out = nl_means(shading, {});
    for (std::size_t i = 0; i < out.values().size(); ++i) {
        ASSERT_NEAR(out.values()[i], shading.values.values()[i], 1e-6);
    }
    std::ranges::fill(shading.values.values(), 0.7f);
    for (const NlmForm form : {NlmForm::Standard, NlmForm::Thesis}) {
        const auto result = nl_means(shading, {.form = form});
        for (const float v : result.values()) ASSERT_NEAR(v, 0.7f, 1e-6);
    }
}

TEST(FdfNlMeans, FollowsTheVariances) {  // the same values are noise or detail
    ShadingCase shading = noisy_shading(64, 64, 5);
    const auto spread = [&] {
        const Planes out = nl_means(shading, {});
        double sum = 0.0;
        for (std::uint32_t y = 20; y < 40; ++y) {
            for (std::uint32_t x = 2; x < 20; ++x) {
                if (shading.classes.row(0, y)[x] != Surface) continue;
                sum += (out.row(0, y)[x] - 1.0) * (out.row(0, y)[x] - 1.0);
            }
        }
        return sum;
    };
    const double known = spread();
    for (float& v : shading.variances.values()) v *= 1e-3f;
    EXPECT_GT(spread(), 10.0 * known);
}

// Two pixels: the weight of the right one in the left one's result.
double weight_of_two(Inputs inputs, const std::string& options = "") {
    for (std::uint32_t c = 0; c < 3; ++c) {
        mean(inputs, Channel::Radiance).plane(c)[0] = 0.0f;
        mean(inputs, Channel::Radiance).plane(c)[1] = 1.0f;
    }
    const Output out = run_filter("fdf:prefilter=off,blend=off" + options, inputs);
    const double value = out.picture.plane(0)[0];
    const double n = inputs.counts.plane(0)[0], m = inputs.counts.plane(0)[1];
    return value / (1.0 - value) * n / m;
}

// Shading of 1 -+ d / 2: it is divided by its mean.
Inputs shaded_pair(float d, float n, float m) {
    Inputs inputs = plain(2, 1);
    inputs.counts.plane(0)[0] = n;
    inputs.counts.plane(0)[1] = m;
    mean(inputs, Channel::ShadingFeature).plane(0)[0] = 1.0f - d / 2.0f;
    mean(inputs, Channel::ShadingFeature).plane(0)[1] = 1.0f + d / 2.0f;
    return inputs;
}

TEST(Fdf, AWeightIsOneOverEAtEachThreshold) {  // LT10
    const double e = std::exp(-1.0);
    EXPECT_NEAR(weight_of_two(plain(2, 1)), 1.0, 1e-6);
    Inputs inputs = plain(2, 1);
    mean(inputs, Channel::Albedo).plane(1)[1] += 0.03f;
    EXPECT_NEAR(weight_of_two(inputs), e, 2e-5);
    inputs = plain(2, 1);
    mean(inputs, Channel::Normal).plane(0)[1] += 0.12f;  // 0.06 when mapped to [0, 1]
    EXPECT_NEAR(weight_of_two(inputs), e, 2e-5);
    for (const float n : {3.0f, 4.0f, 16.0f, 1000.0f}) {
        EXPECT_NEAR(weight_of_two(shaded_pair(5.0f / n, n, n)), e, 2e-4) << n;
    }
    inputs = plain(2, 1);
    mean(inputs, Channel::Albedo).plane(0)[1] += 0.2f;
    EXPECT_NEAR(weight_of_two(inputs, ",t_max=0.2"), e, 2e-5);
}

TEST(Fdf, TheWeightUsesTheLargestDistance) {  // LT11
    Inputs inputs = plain(2, 1);
    mean(inputs, Channel::Albedo).plane(1)[1] += 0.06f;
    const double weight = weight_of_two(inputs);
    mean(inputs, Channel::Albedo).plane(2)[1] -= 0.05f;
    mean(inputs, Channel::Normal).plane(1)[1] += 0.2f;
    EXPECT_EQ(weight_of_two(inputs), weight);
    mean(inputs, Channel::Normal).plane(1)[1] += 0.2f;
    EXPECT_LT(weight_of_two(inputs), 0.6 * weight);
}

TEST(Fdf, ShadingCountsInProportionToTheSamplesOfThePoorerPixel) {  // LT12, L13
    const double at4 = weight_of_two(shaded_pair(0.5f, 4.0f, 4.0f));
    EXPECT_NEAR(weight_of_two(shaded_pair(0.5f, 16.0f, 16.0f)), std::pow(at4, 4.0), 1e-5);
    EXPECT_NEAR(weight_of_two(shaded_pair(0.5f, 4.0f, 1000.0f)), at4, 1e-5);
    EXPECT_NEAR(weight_of_two(shaded_pair(0.5f, 1000.0f, 4.0f)), at4, 1e-4);
}

// Features that vary as in a picture, with different counts in every pixel, a background and holes.
Inputs varied(std::uint32_t width, std::uint32_t height, bool with_alpha) {
    Inputs inputs = plain(width, height, with_alpha);
    std::mt19937_64 random(9);
    std::uniform_real_distribution<float> uniform;
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::size_t i = std::size_t{y} * width + x;
            inputs.counts.plane(0)[i] = random() % 11 == 0 ? 0.0f : float(1 + random() % 9);
            const bool miss = y < height / 5 || inputs.counts.plane(0)[i] == 0.0f;
            if (miss) mean(inputs, Channel::Depth).plane(0)[i] = INFINITY;
            if (with_alpha) mean(inputs, Channel::Alpha).plane(0)[i] = miss ? 0.0f : 1.0f;
            for (std::uint32_t c = 0; c < 3; ++c) {
                mean(inputs, Channel::Radiance).plane(c)[i] = uniform(random);
                mean(inputs, Channel::Albedo).plane(c)[i] = miss ? 0.0f : 0.5f + 0.1f * uniform(random);
                mean(inputs, Channel::Normal).plane(c)[i] = miss ? 0.0f : 0.3f * uniform(random);
            }
            mean(inputs, Channel::ShadingFeature).plane(0)[i] = 2.0f * uniform(random);
        }
    }
    return inputs;
}

// E-L8, E-L9 as published, with the counts.
double direct_bilateral(const Inputs& inputs, const Planes& shading, const Planes& classes, int radius, int x,
                        int y, std::uint32_t component) {
    const auto index = [&](int i, int j) {
        return static_cast<std::size_t>(j) * inputs.width + std::size_t(i);
    };
    const std::size_t p = index(x, y);
    double sum = 0.0, weights = 0.0;
    for (int j = std::max(0, y - radius); j <= std::min(int(inputs.height) - 1, y + radius); ++j) {
        for (int i = std::max(0, x - radius); i <= std::min(int(inputs.width) - 1, x + radius); ++i) {
            const std::size_t q = index(i, j);
            if (classes.plane(0)[p] != classes.plane(0)[q]) continue;
            const double n = inputs.counts.plane(0)[p], m = inputs.counts.plane(0)[q];
            double d = std::abs(shading.plane(0)[p] - shading.plane(0)[q]) * std::min(n, m) / 5.0;
            for (std::uint32_t c = 0; c < 3; ++c) {
                const auto difference = [&](Channel channel) {
                    return std::abs(double(inputs.mean(channel).plane(c)[p]) -
                                    inputs.mean(channel).plane(c)[q]);
                };
                d = std::max(
                    {d, difference(Channel::Albedo) / 0.03, difference(Channel::Normal) / 2.0 / 0.06});
            }
            sum += m * std::exp(-d) * inputs.color(component)[q];
            weights += m * std::exp(-d);
        }
    }
    return sum / weights;
}

Planes classes_of(const Inputs& inputs) {
    Planes classes(inputs.width, inputs.height, 1);
    for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
        classes.plane(0)[i] = inputs.counts.plane(0)[i] == 0.0f                        ? Hole
                              : std::isfinite(inputs.mean(Channel::Depth).plane(0)[i]) ? Surface
                                                                                       : Background;
    }
    return classes;
}

struct Bilateral {
    Planes picture, self_weight;
};
Bilateral bilateral(const Inputs& inputs, const FeatureSettings& settings) {
    Bilateral out{Planes(inputs.width, inputs.height, inputs.color_components()),
                  Planes(inputs.width, inputs.height, 1)};
    tbb::task_arena arena(2);
    RunContext context{arena, {}};
    FeatureBilateral filter;
    EXPECT_TRUE(filter.run(inputs, inputs.mean(Channel::ShadingFeature), classes_of(inputs), settings,
                           out.picture, out.self_weight, context));
    return out;
}

TEST(Fdf, EqualsTheDirectSums) {
    for (const bool with_alpha : {false, true}) {
        const Inputs inputs = varied(77, 41, with_alpha);
        const Planes classes = classes_of(inputs);
        for (const std::uint32_t radius : {8u, 0u, 1u, 16u}) {
            const Bilateral out = bilateral(inputs, {.radius = radius});
            for (std::uint32_t y = 0; y < 41; y += 2) {
                for (std::uint32_t x = 0; x < 77; x += 3) {
                    const std::size_t i = std::size_t{y} * 77 + x;
                    if (inputs.counts.plane(0)[i] == 0.0f) continue;
                    for (std::uint32_t c = 0; c < inputs.color_components(); ++c) {
                        ASSERT_NEAR(out.picture.plane(c)[i],
                                    direct_bilateral(inputs, inputs.mean(Channel::ShadingFeature), classes,
                                                     int(radius), int(x), int(y), c),
                                    1e-5)
                            << radius << " " << x << " " << y;
                    }
                }
            }
        }
    }
}

TEST(Fdf, WeightsDoNotDependOnColour) {  // LT13
    Inputs inputs = varied(70, 40, false);
    const Bilateral before = bilateral(inputs, {});
    std::ranges::reverse(mean(inputs, Channel::Radiance).values());
    const Bilateral after = bilateral(inputs, {});
    EXPECT_TRUE(std::ranges::equal(before.self_weight.values(), after.self_weight.values()));
    EXPECT_FALSE(std::ranges::equal(before.picture.values(), after.picture.values()));
}

TEST(Fdf, StaysWithinTheValuesOfItsWindow) {
    const Inputs inputs = varied(70, 40, false);
    const auto result = bilateral(inputs, {});
    for (const float v : result.picture.values()) {
        ASSERT_GE(v, 0.0f);
        ASSERT_LE(v, 1.0f + 1e-6f);
    }
}

TEST(Fdf, BackgroundAndObjectsDoNotMix) {
    for (const bool with_alpha : {false, true}) {
        Inputs inputs = plain(40, 30, with_alpha);
        for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
            const bool sky = i % 40 < 20;
            inputs.counts.plane(0)[i] = 1.0f;
            for (std::uint32_t c = 0; c < 3; ++c) {  // a black object that faces nowhere before a bright sky
                mean(inputs, Channel::Albedo).plane(c)[i] = mean(inputs, Channel::Normal).plane(c)[i] = 0.0f;
                mean(inputs, Channel::Radiance).plane(c)[i] = sky ? 1e6f : 1e-3f;
            }
            mean(inputs, Channel::ShadingFeature).plane(0)[i] = 0.0f;
            if (sky) mean(inputs, Channel::Depth).plane(0)[i] = INFINITY;
            if (sky && with_alpha) mean(inputs, Channel::Alpha).plane(0)[i] = 0.0f;
        }
        const Output out = run_filter("fdf", inputs);
        for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
            const float want = i % 40 < 20 ? 1e6f : 1e-3f;
            ASSERT_NEAR(out.picture.plane(0)[i], want, 1e-5f * want);
            if (!with_alpha) continue;
            ASSERT_NEAR(out.picture.plane(3)[i], i % 40 < 20 ? 0.0f : 1.0f, i % 40 < 20 ? 0.0 : 1e-6);
        }
    }
}

TEST(Fdf, FiniteAtAnyRangeAndThreshold) {
    std::mt19937_64 random(4);
    for (const char* options :
         {"", ":t_max=0.0001,n_max=0.0001,s_max=0.001", ":s_max=1000000,t_max=100,n_max=100", ":nlm=thesis",
          ":demodulate=on", ":prefilter=off", ":radius=16,nlm_radius=10,patch=4",
          ":radius=0,nlm_radius=0,patch=0"}) {
        for (const float scale : {0.0f, 1e-30f, 1e-10f, 1.0f, 1e12f, 1e30f}) {
            Inputs inputs = varied(37, 23, true);
            for (float& v : mean(inputs, Channel::ShadingFeature).values()) v *= scale;
            for (float& v : mean(inputs, Channel::Radiance).values()) v *= random() % 9 == 0 ? scale : 1.0f;
            for (float& v : variance(inputs, Channel::Radiance).values()) v = std::min(scale, 1e18f);
            for (float& v : variance(inputs, Channel::ShadingFeature).values())
                v = std::min(scale * scale, 3e38f);
            const Output out = run_filter(std::string("fdf") + options, inputs);
            for (const float v : out.picture.values())
                ASSERT_TRUE(std::isfinite(v)) << options << " " << scale;
        }
    }
}

TEST(Fdf, WithoutFeaturesItWarnsAndStillFilters) {
    Inputs inputs = plain(20, 20);
    for (const Channel channel :
         {Channel::Albedo, Channel::Normal, Channel::Depth, Channel::ShadingFeature}) {
        mean(inputs, channel) = {};
        variance(inputs, channel) = {};
    }
    const Output out = run_filter("fdf:demodulate=on", inputs);
    for (const float v : out.picture.values()) ASSERT_NEAR(v, 0.5f, 1e-6f);
}

TEST(Fdf, OneHoleInAnObjectTakesTheObjectsColour) {
    Inputs inputs = plain(40, 40);
    inputs.counts.row(0, 20)[20] = 0.0f;
    for (std::uint32_t c = 0; c < 3; ++c) mean(inputs, Channel::Radiance).row(c, 20)[20] = 0.0f;
    mean(inputs, Channel::Depth).row(0, 20)[20] = INFINITY;
    EXPECT_NEAR(run_filter("fdf", inputs).picture.row(1, 20)[20], 0.5f, 1e-6f);
}

TEST(Fdf, DemodulationKeepsTextureThatTheThresholdsWouldBlur) {
    Inputs inputs = plain(40, 40);
    for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
        for (std::uint32_t c = 0; c < 3; ++c) {
            const float albedo = 0.5f + 0.005f * float(i % 2);
            mean(inputs, Channel::Albedo).plane(c)[i] = albedo;
            mean(inputs, Channel::Radiance).plane(c)[i] = 2.0f * albedo;
        }
    }
    const auto contrast = [&](const std::string& options) {
        const Output out = run_filter("fdf:blend=off" + options, inputs);
        return out.picture.row(0, 20)[21] - out.picture.row(0, 20)[20];
    };
    EXPECT_LT(contrast(""), 0.005f);
    EXPECT_NEAR(contrast(",demodulate=on"), 0.01f, 1e-5f);
}

}  // namespace
}  // namespace tessera::filter
