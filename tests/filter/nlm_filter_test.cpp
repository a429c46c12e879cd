// Multi-scale NL-means of the colour: the fast form against the definition, and what it preserves.
#include <gtest/gtest.h>

#include <cmath>

#include "master/filter/nlm/color_nl_means.h"
#include "master/filter/nlm/pyramid.h"
#include "mediator/base/random.h"
#include "tests/filter/synthetic.h"

namespace tessera::filter {
namespace {

class NlmTest : public testing::Test {
  protected:
    tbb::task_arena arena{2};
    RunContext context{arena, {}};
};

Planes random_planes(std::uint32_t width, std::uint32_t height, std::uint32_t components,
                     std::uint64_t seed) {
    Planes planes(width, height, components);
    CounterRandom random(seed);
    for (float& value : planes.values()) value = static_cast<float>(random.uniform());
    return planes;
}

// E-L4 and E-L5 as published, in double.
Planes by_definition(const Planes& match, const Planes& color, const Planes& known, int radius, int patch,
                     double k, double epsilon) {
    const int width = static_cast<int>(color.width()), height = static_cast<int>(color.height());
    const auto inside = [&](int x, int y) { return x >= 0 && x < width && y >= 0 && y < height; };
    const auto pair = [&](int ax, int ay, int bx, int by) {
        double square = 0.0;
        for (std::uint32_t c = 0; c < 3; ++c) {
            const double d = double(match.row(c, ay)[ax]) - double(match.row(c, by)[bx]);
            square += d * d;
        }
        const double va = match.row(3, ay)[ax], vb = match.row(3, by)[bx];
        return (square - va - std::min(va, vb)) / (epsilon + k * k * (va + vb));
    };
    Planes out(color.width(), color.height(), color.components());
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            double weights = 0.0;
            std::vector<double> sums(color.components());
            for (int dy = -radius; dy <= radius; ++dy) {
                for (int dx = -radius; dx <= radius; ++dx) {
                    if (!inside(x + dx, y + dy)) continue;
                    double distance = 0.0, pairs = 0.0;
                    for (int v = -patch; v <= patch; ++v) {
                        for (int u = -patch; u <= patch; ++u) {
                            if (!inside(x + u, y + v) || !inside(x + dx + u, y + dy + v)) continue;
                            distance += pair(x + u, y + v, x + dx + u, y + dy + v);
                            pairs += 1.0;
                        }
                    }
                    const double w =
                        known.row(0, y + dy)[x + dx] * std::exp(-std::max(0.0, distance / pairs));
                    weights += w;
                    for (std::uint32_t c = 0; c < color.components(); ++c) {
                        sums[c] += w * color.row(c, y + dy)[x + dx];
                    }
                }
            }
            for (std::uint32_t c = 0; c < color.components(); ++c) {
                out.row(c, y)[x] = static_cast<float>(sums[c] / weights);
            }
        }
    }
    return out;
}

TEST_F(NlmTest, BoxesOfPairsEqualTheDefinition) {
    // More than one band of rows; a few pixels without samples.
    const std::uint32_t width = 23, height = 41;
    Planes match = random_planes(width, height, 4, 1), known(width, height, 1);
    for (float& variance : match.plane(3)) variance *= 0.3f;
    const Planes color = random_planes(width, height, 4, 2);
    for (std::size_t i = 0; i < known.pixel_count(); ++i) known.plane(0)[i] = mix(i) % 7 == 0 ? 0.0f : 1.0f;
    ColorNlMeans windows;
    Planes out;
    ASSERT_TRUE(windows.run(match, color, known, {.radius = 4, .patch = 2, .k = 0.8f, .epsilon = 1e-6f}, out,
                            context));
    const Planes expected = by_definition(match, color, known, 4, 2, 0.8, 1e-6);
    double worst = 0.0, moved = 0.0;
    for (std::size_t i = 0; i < out.values().size(); ++i) {
        worst = std::max(worst, std::abs(double(out.values()[i]) - expected.values()[i]));
        moved = std::max(moved, std::abs(double(color.values()[i]) - expected.values()[i]));
    }
    EXPECT_LT(worst, 1e-5);
    EXPECT_GT(moved, 0.1);  // the case is one where filtering does something
}

TEST_F(NlmTest, AStepWithoutNoiseIsNotCrossed) {
    const Inputs inputs = synthetic_inputs(48, 40, 4, [](auto x, auto, auto) {
        SyntheticSample s;
        const float light = x < 24 ? 0.2f : 0.25f;
        s.high = {light, light, light};
        return s;
    });
    const Output out = run_filter("nlm:scales=1", inputs);
    for (std::uint32_t y = 0; y < 40; ++y) {
        for (std::uint32_t x = 0; x < 48; ++x) {
            ASSERT_NEAR(out.picture.row(0, y)[x], x < 24 ? 0.2f : 0.25f, 1e-6f) << x << ", " << y;
        }
    }
}

TEST_F(NlmTest, ARampIsKept) {
    Inputs inputs = synthetic_inputs(96, 96, 4, [](auto x, auto y, auto) {
        SyntheticSample s;
        const float light = 0.2f + 0.004f * static_cast<float>(x) + 0.002f * static_cast<float>(y);
        s.high = {light, light, light};
        return s;
    });
    for (float& variance : inputs.variances[0].values()) variance = 1e-4f;
    const Output out = run_filter("nlm", inputs);
    for (std::uint32_t y = 44; y < 52; ++y) {  // beyond the influence of the borders at three scales
        for (std::uint32_t x = 44; x < 52; ++x) {
            ASSERT_NEAR(out.picture.row(0, y)[x], inputs.color(0)[x + 96 * y], 2e-6f) << x << ", " << y;
        }
    }
}

TEST_F(NlmTest, CoarseScalesRemoveLowFrequencyNoise) {
    const Inputs inputs = synthetic_inputs(96, 96, 4, [](auto x, auto y, auto i) {
        CounterRandom random(5, mix((std::uint64_t{y} << 32 | x) ^ mix(i)));
        SyntheticSample s;
        const auto light = static_cast<float>(random.uniform());
        s.high = {light, light, light};
        return s;
    });
    // Error of means over 8 x 8 pixels.
    const auto slow_error = [](const Planes& picture) {
        double error = 0.0;
        for (std::uint32_t top = 0; top < 96; top += 8) {
            for (std::uint32_t left = 0; left < 96; left += 8) {
                double mean = 0.0;
                for (std::uint32_t i = 0; i < 64; ++i)
                    mean += picture.row(0, top + i / 8)[left + i % 8] / 64.0;
                error += (mean - 0.5) * (mean - 0.5);
            }
        }
        return error;
    };
    EXPECT_LT(slow_error(run_filter("nlm:scales=3", inputs).picture),
              0.7 * slow_error(run_filter("nlm:scales=1", inputs).picture));
}

TEST_F(NlmTest, OneSampleHasTheVarianceOfItsNeighbourhood) {
    const auto noisy = [](auto x, auto y, auto i) { return shadowed_texture(96, 96, x, y, i); };
    const Inputs inputs = synthetic_inputs(96, 96, 1, noisy);
    const Planes truth = shadowed_texture_truth(96, 96);
    EXPECT_LT(mean_squared_error(run_filter("nlm", inputs).picture, truth),
              0.25 * mean_squared_error(run_filter("none", inputs).picture, truth));
}

// --- scales

TEST_F(NlmTest, HalvingKeepsConstantsAndPropagatesVariances) {
    Planes flat(21, 13, 1), half, half_variance;
    std::ranges::fill(flat.values(), 3.0f);
    halve(flat, half, context);
    halve_variance(flat, half_variance, context);
    ASSERT_EQ(half.width(), 11u);
    ASSERT_EQ(half.height(), 7u);
    for (const float value : half.values()) EXPECT_NEAR(value, 3.0f, 1e-6f);
    // Sum of the squared weights of a Gauss of sigma 0.9526 at +-0.5, +-1.5, +-2.5, in two dimensions.
    double sum = 0.0, squares = 0.0;
    for (const double t : {0.5, 1.5, 2.5}) {
        const double w = std::exp(-0.5 * t * t / (0.9526279 * 0.9526279));
        sum += 2.0 * w;
        squares += 2.0 * w * w;
    }
    for (const float value : half_variance.values()) {
        EXPECT_NEAR(value, 3.0 * std::pow(squares / (sum * sum), 2.0), 1e-5);
    }
}

TEST_F(NlmTest, ADifferenceOfConstantsIsAddedEverywhere) {
    Planes from(8, 5, 2), halved(8, 5, 2), to(15, 10, 2);
    std::ranges::fill(from.values(), 2.5f);
    std::ranges::fill(halved.values(), 1.0f);
    std::ranges::fill(to.values(), 0.25f);
    add_difference(from, halved, to, context);
    for (const float value : to.values()) EXPECT_NEAR(value, 1.75f, 1e-6f);
}

}  // namespace
}  // namespace tessera::filter
