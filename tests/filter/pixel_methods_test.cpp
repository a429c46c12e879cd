// The cross-bilateral filters of the pixel filter on synthetic pictures: variance reduction, edges,
// antialiased edges (Schwenk 3.3.3, 3.6).
#include <gtest/gtest.h>

#include <array>
#include <functional>

#include "master/filter/pixel/edge_model.h"
#include "tests/filter/pixel_pictures.h"

namespace tessera::filter {
namespace {

// Mean and variance over pictures of the pixels that `counts`, and the mean of r there.
struct Spread {
    double variance = 0.0, reduction = 0.0;
};

template <class Headlight, class Counts>
Spread spread_of(const std::string& choice, std::uint32_t size, int pictures, const Headlight& headlight,
                 const Counts& counts) {
    Spread spread;
    double number = 0.0;
    for (int picture = 0; picture < pictures; ++picture) {
        const Inputs inputs = pixel_inputs(size, size, [&](std::uint32_t x, std::uint32_t y) {
            const float value = noise(static_cast<std::uint64_t>(picture) + 1, x, y);
            return PixelLight{.high = value, .variance = 1.0f / 12.0f, .headlight = headlight(x, y)};
        });
        const Output out = run_filter(choice, inputs, true);
        const Planes& reduction = map_of(out, "reduction");
        for (std::uint32_t y = 0; y < size; ++y) {
            for (std::uint32_t x = 0; x < size; ++x) {
                if (!counts(x, y)) continue;
                const double off = out.picture.row(0, y)[x] - 0.5;
                spread.variance += off * off;
                spread.reduction += reduction.row(0, y)[x];
                number += 1.0;
            }
        }
    }
    spread.variance *= 12.0 / number;  // relative to that of the noise
    spread.reduction /= number;
    return spread;
}

struct Flat {
    std::string method;
    double sigma, tolerance;
};

class Reduction : public testing::TestWithParam<Flat> {};

TEST_P(Reduction, IsTheRemainingVariance) {
    const auto& [method, sigma, tolerance] = GetParam();
    constexpr std::uint32_t Size = 96;
    const auto border = static_cast<std::uint32_t>(4.0 * sigma);
    const Spread spread = spread_of(
        FilteredLight + ",method=" + method + ",sigma_s=" + std::to_string(sigma), Size, 200,
        [](std::uint32_t, std::uint32_t) { return 0.5f; },
        [&](std::uint32_t x, std::uint32_t y) {
            return std::min(x, y) >= border && std::max(x, y) < Size - border;
        });
    EXPECT_NEAR(spread.variance / spread.reduction, 1.0, tolerance);
    if (method == "atrous") return;
    EXPECT_NEAR(spread.reduction * 4.0 * M_PI * sigma * sigma, 1.0, 0.05);
}

INSTANTIATE_TEST_SUITE_P(Methods, Reduction,
                         testing::Values(Flat{"brute", 2.0, 0.05}, Flat{"brute", 4.0, 0.05},
                                         Flat{"separable", 2.0, 0.05}, Flat{"separable", 4.0, 0.05},
                                         Flat{"atrous", 4.0, 0.10}),
                         [](const auto& tested) {
                             return tested.param.method + std::to_string(int(tested.param.sigma));
                         });

// With stripes and checkers only parts of the window are similar.
TEST(Reduction, IsEstimatedWithinAFifthNextToEdges) {
    const auto checker = [](std::uint32_t x, std::uint32_t y) {
        return (x / 12 + y / 12) % 2 == 0 ? 0.2f : 0.8f;
    };
    for (const char* recovery : {"on", "off"}) {
        const Spread spread = spread_of(
            FilteredLight + ",sigma_s=4,aa_recovery=" + recovery, 96, 200, checker,
            [](std::uint32_t x, std::uint32_t y) { return std::min(x, y) >= 12 && std::max(x, y) < 84; });
        EXPECT_NEAR(spread.variance / spread.reduction, 1.0, 0.2) << recovery;
    }
}

class Leak : public testing::TestWithParam<std::string> {};

// The left half is dark, the right one bright, and nothing may cross.
double leak(const std::string& choice, const std::function<void(PixelLight&)>& right_side) {
    const Inputs inputs = pixel_inputs(64, 40, [&](std::uint32_t x, std::uint32_t) {
        PixelLight light{.high = x < 32 ? 0.0f : 1.0f, .variance = 1.0f};
        if (x >= 32) right_side(light);
        return light;
    });
    const Output out = run_filter(choice, inputs);
    double worst = 0.0;
    for (std::uint32_t y = 0; y < 40; ++y) {
        for (std::uint32_t x = 0; x < 64; ++x) {
            worst = std::max(worst, std::abs(double(out.picture.row(0, y)[x]) - (x < 32 ? 0.0 : 1.0)));
        }
    }
    return worst;
}

TEST_P(Leak, IsZeroAcrossHeadlightEdges) {
    const std::string choice = FilteredLight + ",method=" + GetParam();
    // A step of 5 sigma_c in each of three channels: 8.7 together.
    EXPECT_LT(leak(choice, [](PixelLight& light) { light.headlight += 5.0f * 0.02f; }), 1e-5);
    EXPECT_GT(leak(choice, [](PixelLight& light) { light.headlight += 0.005f; }), 0.1);
}

TEST_P(Leak, IsZeroAcrossDepths) {
    const std::string choice = FilteredLight + ",method=" + GetParam();
    EXPECT_LT(leak(choice, [](PixelLight& light) { light.depth += 6.0f * 2.0f; }), 1e-5);
    EXPECT_GT(leak(choice, [](PixelLight& light) { light.depth += 0.5f; }), 0.1);
    constexpr float Miss = std::numeric_limits<float>::infinity();
    EXPECT_LT(leak(choice, [](PixelLight& light) { light.depth = Miss; }), 1e-5);
}

TEST_P(Leak, IsZeroAcrossNormalsWhenUsed) {
    const std::string choice = FilteredLight + ",method=" + GetParam();
    const auto tilted = [](PixelLight& light) { light.normal_z = 0.0f; };
    EXPECT_LT(leak(choice + ",normals=on", tilted), 1e-5);
    EXPECT_GT(leak(choice, tilted), 0.1);
}

INSTANTIATE_TEST_SUITE_P(Methods, Leak, testing::Values("separable", "brute", "atrous"),
                         [](const auto& tested) { return tested.param; });

TEST(Misses, AreFilteredAmongThemselves) {
    constexpr float Miss = std::numeric_limits<float>::infinity();
    const Inputs inputs = pixel_inputs(48, 48, [](std::uint32_t x, std::uint32_t y) {
        return PixelLight{.high = noise(5, x, y), .variance = 1.0f / 12.0f, .headlight = 0.0f, .depth = Miss};
    });
    for (const char* method : {"separable", "brute", "atrous"}) {
        const Output out = run_filter(FilteredLight + ",method=" + method, inputs);
        EXPECT_NEAR(out.picture.row(0, 24)[24], 0.5, 0.05) << method;
    }
}

// Rows and columns cover less of a checkerboard than the plane, so that the methods differ by their bias;
// with more samples both converge.
TEST(Separable, ComesCloserToBruteForceWithSamplesAndIsAsGood) {
    const Planes truth = shadowed_texture_truth(96, 96);
    double last = 23.0;
    for (const std::uint64_t n : {4, 16, 64, 256}) {
        const Inputs inputs =
            synthetic_inputs(96, 96, n, [](std::uint32_t x, std::uint32_t y, std::uint64_t i) {
                return shadowed_texture(96, 96, x, y, i);
            });
        const Planes fast = run_filter("pixel:adaptive=off", inputs).picture;
        const Planes exact = run_filter("pixel:adaptive=off,method=brute", inputs).picture;
        const double psnr = -10.0 * std::log10(mean_squared_error(fast, exact) / 3.0);
        EXPECT_GT(psnr, last) << n;
        last = psnr;
        if (n > 16) continue;
        EXPECT_LT(mean_squared_error(fast, truth), 1.05 * mean_squared_error(exact, truth)) << n;
    }
}

// Two regions and a mixed column between them.
TEST(EdgeModel, FindsTheCoverage) {
    using namespace pixel;
    constexpr std::ptrdiff_t Pitch = 64;
    for (double coverage = 0.0; coverage <= 1.0; coverage += 0.05) {
        std::array<std::vector<float>, 4> planes;
        const std::array<double, 4> left{10.0, 5.0, 20.0, 1.0}, right{40.0, 25.0, -10.0, 1.0};
        for (std::size_t k = 0; k < 4; ++k) {
            planes[k].resize(3 * Pitch);
            for (std::size_t i = 0; i < planes[k].size(); ++i) {
                const std::size_t x = i % Pitch;
                const double part = x < 24 ? 0.0 : x > 24 ? 1.0 : coverage;
                planes[k][i] = static_cast<float>((1.0 - part) * left[k] + part * right[k]);
            }
        }
        std::array<const float*, 4> sources;
        std::array<Pack, 4> target;
        for (std::size_t k = 0; k < 4; ++k) {
            sources[k] = planes[k].data() + Pitch + 24;
            target[k] = load(sources[k]);
        }
        const auto model = edge_model<4>(sources, target, 1, -Pitch, Pitch);
        EXPECT_NEAR(model.coverage[0], coverage, 0.02);
        EXPECT_NEAR(model.belief[0], 1.0f, 1e-4f);
        EXPECT_EQ(model.belief[4], 0.0f);  // within one region
        target[0] = target[0] + 5.0f;      // off the line from one to the other
        EXPECT_LT(edge_model<4>(sources, target, 1, -Pitch, Pitch).belief[0], 0.01f);
    }
}

TEST(AntialiasRecovery, ReducesNoiseOfEdgePixelsAndKeepsTheirMean) {
    constexpr std::uint32_t Size = 64, Edge = 32;
    for (const float coverage : {0.25f, 0.5f, 0.7f}) {
        double recovered = 0.0, plain = 0.0, unfiltered = 0.0, mean = 0.0, number = 0.0;
        const float expected = (1.0f - coverage) * 0.3f + coverage * 1.0f;
        for (int picture = 0; picture < 20; ++picture) {
            const auto seed = static_cast<std::uint64_t>(picture) + 1;
            const Inputs inputs = pixel_inputs(Size, Size, [&](std::uint32_t x, std::uint32_t y) {
                const float part = x < Edge ? 0.0f : x > Edge ? 1.0f : coverage;
                const float light = 0.3f + 0.7f * part;
                const float value = light * (0.5f + noise(seed, x, y));
                return PixelLight{
                    .high = value, .variance = light * light / 12.0f, .headlight = 0.2f + 0.6f * part};
            });
            const Output with = run_filter(FilteredLight, inputs);
            const Output without = run_filter(FilteredLight + ",aa_recovery=off", inputs);
            // Along the edge the one-dimensional sweeps find its other pixels, which is fair; a diagonal edge
            // has none, so rows are checked one by one.
            for (std::uint32_t y = 12; y < Size - 12; ++y) {
                const auto square = [&](float value) { return (value - expected) * (value - expected); };
                recovered += square(with.picture.row(0, y)[Edge]);
                plain += square(without.picture.row(0, y)[Edge]);
                unfiltered += square(inputs.mean(frame::Channel::HighVariance).row(0, y)[Edge]);
                mean += with.picture.row(0, y)[Edge];
                number += 1.0;
            }
        }
        EXPECT_LT(5.0 * recovered, unfiltered) << coverage;
        EXPECT_LT(recovered, 0.5 * plain) << coverage;
        EXPECT_NEAR(mean / number, expected, 0.02) << coverage;
    }
}

}  // namespace
}  // namespace tessera::filter
