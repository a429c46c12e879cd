// The 5x5 levels of the original SVGF against their formula, pixel by pixel.
#include <gtest/gtest.h>

#include <cmath>

#include "master/filter/svgf/atrous_wavelet_5x5.h"
#include "mediator/base/random.h"

namespace tessera::filter::svgf {
namespace {

// Tilted surfaces of two objects, noisy light.
struct Wide {
    Wide(std::uint32_t width, std::uint32_t height)
        : guides{Planes(width, height, 3),
                 Planes(width, height, 1),
                 Planes(width, height, 2),
                 std::vector<std::uint32_t>(std::size_t{width} * height),
                 {}} {
        picture.fit(width, height, SignalComponents);
        CounterRandom random(5, width);
        for (std::uint32_t y = 0; y < height; ++y) {
            for (std::uint32_t x = 0; x < width; ++x) {
                const float tilt = 0.2f * static_cast<float>(random.uniform());
                guides.normal.row(0, y)[x] = tilt;
                guides.normal.row(2, y)[x] = std::sqrt(1.0f - tilt * tilt);
                guides.inverse_depth.row(0, y)[x] = 1.0f + 0.01f * static_cast<float>(random.uniform());
                for (std::uint32_t c = 0; c < 2; ++c) {
                    guides.slope.row(c, y)[x] = 0.4f * static_cast<float>(random.uniform() - 0.5);
                }
                guides.ids[std::size_t{y} * width + x] = random.uniform() < 0.8 ? 1 : 2;
                for (std::uint32_t c = 0; c < SignalComponents; ++c) {
                    picture.row(c, y)[x] = static_cast<float>(random.uniform());
                }
            }
        }
    }
    PaddedPlanes filtered(std::uint32_t level, const EdgeStops& stops, int threads = 2) const {
        PaddedPlanes out;
        out.fit(picture.width(), picture.height(), SignalComponents);
        tbb::task_arena arena(threads);
        RunContext context{arena, {}};
        EXPECT_TRUE(AtrousWavelet5x5().run(guides, stops, level, picture, out, context));
        return out;
    }

    Guides guides;
    PaddedPlanes picture;
};

float light_at(const PaddedPlanes& p, std::int64_t x, std::int64_t y) {
    const auto row = static_cast<std::uint32_t>(y);
    return luma(p.row(0, row)[x], p.row(1, row)[x], p.row(2, row)[x]);
}

// E-D8 to E-D13, at (x, y).
std::array<double, SignalComponents> expected_at(const Wide& wide, const EdgeStops& stops, std::int64_t step,
                                                 std::int64_t x, std::int64_t y) {
    constexpr std::array<double, 3> Kernel{6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0};
    const std::int64_t width = wide.picture.width(), height = wide.picture.height();
    const auto at = [](const Planes& planes, std::uint32_t c, std::int64_t u, std::int64_t v) {
        return planes.row(c, static_cast<std::uint32_t>(v))[u];
    };
    std::array<double, SignalComponents> sum{};
    double weights = 0.0;
    for (std::int64_t dy = -2; dy <= 2; ++dy) {
        for (std::int64_t dx = -2; dx <= 2; ++dx) {
            const std::int64_t u = x + dx * step, v = y + dy * step;
            if (u < 0 || v < 0 || u >= width || v >= height) continue;
            double w = Kernel[std::size_t(std::abs(dx))] * Kernel[std::size_t(std::abs(dy))];
            if (dx != 0 || dy != 0) {
                if (wide.guides.ids[std::size_t(y * width + x)] !=
                    wide.guides.ids[std::size_t(v * width + u)]) {
                    continue;
                }
                const bool larger = stops.pair == Pair::Larger;  // deviation
                float dot = 0.0f, depth = 0.0f, light = larger ? 1e30f : 0.0f;
                for (std::uint32_t c = 0; c < 3; ++c) {
                    dot += at(wide.guides.normal, c, x, y) * at(wide.guides.normal, c, u, v);
                }
                for (const auto& [i, j] : {std::pair{x, y}, std::pair{u, v}}) {
                    const float inverse = at(wide.guides.inverse_depth, 0, i, j);
                    const float right = at(wide.guides.slope, 0, i, j), down = at(wide.guides.slope, 1, i, j);
                    const float change = float(step) * (float(dx) * right + float(dy) * down);
                    const bool steep = std::max(std::fabs(right), std::fabs(down)) > stops.steep * inverse;
                    depth = std::max(depth, steep ? 0.0f : depth_scale(inverse, change, stops));
                    const float variance = wide.picture.row(3, std::uint32_t(j))[i];
                    const float own =
                        luminance_scale(light_at(wide.picture, i, j), std::sqrt(variance), stops);
                    light = larger ? std::min(light, own) : std::max(light, own);
                }
                const double apart =
                    double(normal_distance(dot, stops.sigma_n)) +
                    double(depth) * std::fabs(at(wide.guides.inverse_depth, 0, x, y) -
                                              at(wide.guides.inverse_depth, 0, u, v)) +
                    double(light) * std::fabs(light_at(wide.picture, x, y) - light_at(wide.picture, u, v));
                w *= std::exp(-apart);
            }
            for (std::uint32_t c = 0; c < 4; ++c) {
                sum[c] += (c == 3 ? w * w : w) * wide.picture.row(c, std::uint32_t(v))[u];
            }
            weights += w;
        }
    }
    for (std::size_t c = 0; c < 4; ++c) sum[c] /= c == 3 ? weights * weights : weights;
    sum[OwnWeightComponent] =
        Kernel[0] * Kernel[0] / weights * wide.picture.row(OwnWeightComponent, std::uint32_t(y))[x];
    return sum;
}

TEST(Wavelet5x5, FollowsItsFormula) {
    for (const auto& [width, height, pair] :
         {std::tuple{37u, 130u, Pair::Larger}, std::tuple{37u, 130u, Pair::Smaller},
          std::tuple{5u, 3u, Pair::Larger}, std::tuple{1u, 70u, Pair::Larger},
          std::tuple{70u, 1u, Pair::Smaller}}) {
        EdgeStops stops{.pair = pair};
        stops.sigma_l = 0.5f;
        const Wide wide(width, height);
        for (std::uint32_t level = 0; level < MaxLevels5x5; ++level) {
            const PaddedPlanes out = wide.filtered(level, stops);
            for (std::uint32_t y = 0; y < height; ++y) {
                for (std::uint32_t x = 0; x < width; ++x) {
                    const auto expected = expected_at(wide, stops, std::int64_t{1} << level, x, y);
                    for (std::uint32_t c = 0; c < SignalComponents; ++c) {
                        ASSERT_NEAR(out.row(c, y)[x], expected[c], 2e-5)
                            << width << " x " << height << ", level " << level << " at " << x << ", " << y;
                    }
                }
            }
        }
    }
}

TEST(Wavelet5x5, AnyNumberOfThreadsGivesTheSameBits) {
    const Wide wide(60, 200);
    for (const std::uint32_t level : {0u, 2u, 5u}) {
        const PaddedPlanes one = wide.filtered(level, {}, 1), three = wide.filtered(level, {}, 3);
        for (std::uint32_t y = 0; y < 200; ++y) {
            for (std::uint32_t c = 0; c < SignalComponents; ++c) {
                ASSERT_TRUE(std::equal(one.row(c, y), one.row(c, y) + 60, three.row(c, y))) << level;
            }
        }
    }
}

// Without weights, five levels are a Gauss of 18.5 px within 125 px; six of 3x3 one of 26.1 within 127.
TEST(Wavelet5x5, FiveLevelsBlurLessThanSixOf3x3) {  // DT30
    constexpr std::uint32_t Size = 192, Centre = 96;
    Wide wide(Size, Size);
    const EdgeStops open{.sigma_n = 0.0f, .sigma_d = 1e9f, .eps_d = 1e9f, .sigma_l = 1e9f, .eps_l = 1e9f};
    std::ranges::fill(wide.guides.ids, 1u);
    for (std::uint32_t y = 0; y < Size; ++y) {
        for (std::uint32_t c = 0; c < 3; ++c) {
            std::fill_n(wide.picture.row(c, y), Size, 0.0f);
        }
        std::fill_n(wide.picture.row(3, y), Size, 1.0f);
    }
    for (std::uint32_t c = 0; c < 3; ++c) wide.picture.row(c, Centre)[Centre] = 1.0f;
    for (std::uint32_t level = 0; level < 5; ++level) wide.picture = wide.filtered(level, open);
    double sum = 0.0, second = 0.0;
    std::uint32_t first = Size, last = 0;
    for (std::uint32_t y = 0; y < Size; ++y) {
        for (std::uint32_t x = 0; x < Size; ++x) {
            const double v = wide.picture.row(0, y)[x];
            sum += v;
            second += v * (double(x) - Centre) * (double(x) - Centre);
            if (v > 0.0) {
                first = std::min(first, x);
                last = std::max(last, x);
            }
        }
    }
    EXPECT_NEAR(sum, 1.0, 1e-4);
    EXPECT_NEAR(std::sqrt(second), 18.5, 0.05);
    EXPECT_EQ(last - first, 124u);
}

}  // namespace
}  // namespace tessera::filter::svgf
