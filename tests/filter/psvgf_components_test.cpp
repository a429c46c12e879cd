// The components of progressive SVGF: edge stops, wavelet levels, hole filling.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "master/filter/svgf/atrous_wavelet.h"
#include "master/filter/svgf/hole_fill.h"
#include "master/filter/svgf/signal.h"
#include "master/filter/svgf/spatial_variance.h"
#include "mediator/base/random.h"

namespace tessera::filter::svgf {
namespace {

tbb::task_arena& arena() {
    static tbb::task_arena Two(2);
    return Two;
}

// Flat surfaces at depth 1 facing the camera, all of one object, unless changed.
Guides flat(std::uint32_t width, std::uint32_t height) {
    Guides guides{Planes(width, height, 3),
                  Planes(width, height, 1),
                  Planes(width, height, 2),
                  std::vector<std::uint32_t>(std::size_t{width} * height, 1),
                  {}};
    std::ranges::fill(guides.normal.plane(2), 1.0f);
    std::ranges::fill(guides.inverse_depth.plane(0), 1.0f);
    return guides;
}

using Value = std::function<float(std::uint32_t x, std::uint32_t y)>;

PaddedPlanes picture_of(std::uint32_t width, std::uint32_t height, const Value& color,
                        const Value& variance) {
    PaddedPlanes picture;
    picture.fit(width, height, SignalComponents);
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            for (std::uint32_t c = 0; c < 3; ++c) picture.row(c, y)[x] = color(x, y);
            picture.row(3, y)[x] = variance(x, y);
        }
    }
    return picture;
}

PaddedPlanes transform(const Guides& guides, const EdgeStops& stops, const std::vector<std::uint32_t>& levels,
                       PaddedPlanes picture) {
    AtrousWavelet wavelet;
    RunContext context{arena(), {}};
    PaddedPlanes next;
    next.fit(picture.width(), picture.height(), SignalComponents);
    for (const std::uint32_t level : levels) {
        EXPECT_TRUE(wavelet.run(guides, stops, level, picture, next, context));
        std::swap(picture, next);
    }
    return picture;
}

// Edge stops without luminance and depth.
const EdgeStops Open{.sigma_n = 1.0f, .sigma_d = 1e9f, .sigma_l = 1e12f};
const std::vector<std::uint32_t> DundrOrder{0, 5, 4, 3, 2, 1};

float uniform(std::uint64_t seed, std::uint32_t x, std::uint32_t y) {
    return static_cast<float>(CounterRandom(seed, std::uint64_t{y} << 32 | x).uniform());
}

TEST(EdgeStops, NormalsOfTheNotes) {  // DT8
    const auto weight = [](double degrees) {
        return std::exp(-normal_distance(static_cast<float>(std::cos(degrees * M_PI / 180.0)), 64.0f));
    };
    EXPECT_NEAR(weight(0.0), 1.0, 1e-6);
    EXPECT_NEAR(weight(10.0), 0.375, 0.001);
    EXPECT_NEAR(weight(20.0), 0.0187, 0.0002);
}

TEST(EdgeStops, LightOfTheNotes) {  // DT9
    const EdgeStops stops{.sigma_l = 4.0f, .eps_l = 0.1f, .deviation = Deviation::Variance};
    EXPECT_NEAR(luminance_scale(1.0f, 0.0f, stops), 10.0f, 1e-4);  // var = 0: exp(-dL / eps)
    EXPECT_NEAR(luminance_scale(1.0f, 0.25f, stops), 1.0f / (4.0f * 0.25f + 0.1f), 1e-5);
}

TEST(EdgeStops, ASlopeIsNoEdge) {  // DT7
    for (const float tilt : {0.001f, 0.01f, 0.1f}) {
        for (std::uint32_t level = 0; level < 6; ++level) {
            const float step = static_cast<float>(1u << level), change = tilt * step;
            const EdgeStops stops;
            EXPECT_GE(std::exp(-change * depth_scale(1.0f, change, stops)), std::exp(-1.0f) - 1e-6f);
            const EdgeStops sharp{.eps_d = 1e-6f};
            EXPECT_LT(std::exp(-10.0f * change * depth_scale(1.0f, change, sharp)), 0.01f);
        }
    }
}

TEST(Wavelet, ImpulseSpreadsAsTheCascade) {  // DT10
    const std::uint32_t size = 192, centre = 96;
    const auto impulse = picture_of(
        size, size, [](auto x, auto y) { return x == 96 && y == 96 ? 1.0f : 0.0f; },
        [](auto, auto) { return 1.0f; });
    const Guides guides = flat(size, size);
    const PaddedPlanes out = transform(guides, Open, DundrOrder, impulse);
    const PaddedPlanes other = transform(guides, Open, {0, 1, 2, 3, 4, 5}, impulse);
    double sum = 0.0, second = 0.0, most = 0.0;
    std::uint32_t first = size, last = 0;
    for (std::uint32_t y = 0; y < size; ++y) {
        for (std::uint32_t x = 0; x < size; ++x) {
            const double v = out.row(0, y)[x];
            sum += v;
            second += v * (double(x) - centre) * (double(x) - centre);
            if (v > 0.0) {
                first = std::min(first, x);
                last = std::max(last, x);
            }
            most = std::max(most, std::abs(v - double(other.row(0, y)[x])));
        }
    }
    EXPECT_NEAR(sum, 1.0, 1e-5);
    EXPECT_EQ(first, centre - 63);
    EXPECT_EQ(last, centre + 63);
    EXPECT_NEAR(std::sqrt(second), 26.1, 0.05);
    EXPECT_LT(most, 1e-6);
}

TEST(Wavelet, VarianceFollowsTheSquaredWeights) {  // DT12
    const std::uint32_t size = 256;
    const auto noise = picture_of(
        size, size, [](auto x, auto y) { return uniform(1, x, y); }, [](auto, auto) { return 1.0f / 12.0f; });
    const Guides guides = flat(size, size);
    // Away from the border, where taps are missing.
    const auto inner = [&](const PaddedPlanes& picture) {
        double sum = 0.0, squares = 0.0, n = 0.0;
        for (std::uint32_t y = 64; y < size - 64; ++y) {
            for (std::uint32_t x = 64; x < size - 64; ++x) {
                const double v = picture.row(0, y)[x];
                sum += v;
                squares += v * v;
                n += 1.0;
            }
        }
        return squares / n - sum / n * sum / n;
    };
    const PaddedPlanes once = transform(guides, Open, {0}, noise);
    EXPECT_NEAR(once.row(3, 128)[128] * 12.0, 9.0 / 64.0, 1e-4);
    EXPECT_NEAR(inner(once) * 12.0, 9.0 / 64.0, 0.01);
    const PaddedPlanes twice = transform(guides, Open, {0, 5}, noise);
    EXPECT_NEAR(twice.row(3, 128)[128] * 12.0, 0.01978, 1e-4);
    EXPECT_NEAR(inner(twice) * 12.0, 0.01978, 0.003);
}

// The response of a pixel to its own impulse after all levels, which no step returns to.
TEST(Wavelet, KnowsThePixelsOwnWeight) {
    const std::uint32_t size = 160, tested = 40;
    Guides guides = flat(size, size);
    for (std::uint32_t y = 0; y < size; ++y) {
        for (std::uint32_t x = 0; x < size; ++x) {
            if (uniform(9, x, y) < 0.5f) guides.ids[std::size_t{y} * size + x] = 2;
        }
    }
    for (std::uint32_t k = 0; k < tested; ++k) {
        const auto px = static_cast<std::uint32_t>(uniform(11, k, 0) * size),
                   py = static_cast<std::uint32_t>(uniform(11, k, 1) * size);
        PaddedPlanes impulse = picture_of(
            size, size, [&](auto x, auto y) { return x == px && y == py ? 1.0f : 0.0f; },
            [](auto, auto) { return 1.0f; });
        for (std::uint32_t y = 0; y < size; ++y) std::fill_n(impulse.row(OwnWeightComponent, y), size, 1.0f);
        const PaddedPlanes out = transform(guides, Open, DundrOrder, impulse);
        const float response = out.row(0, py)[px];
        EXPECT_NEAR(out.row(OwnWeightComponent, py)[px], response, 1e-4f * response) << px << " " << py;
        EXPECT_GT(response, 1e-4f);
    }
}

TEST(Accumulation, KnowsTheWeightOfTheFilmsSamples) {
    const std::uint32_t width = 4;
    Planes history(width, 1, HistoryCount), trust;
    State state{.moments = Planes(width, 1, MomentCount)};
    state.color.fit(width, 1, SignalComponents);
    for (std::uint32_t x = 0; x < width; ++x) {
        history.row(HistoryMoments + Age, 0)[x] = x == 1 ? 0.0f : 3.0f;
        state.moments.row(Age, 0)[x] = x == 2 ? 0.0f : 1.0f;
        state.color.row(OwnWeightComponent, 0)[x] = 1.0f;
        state.color.row(0, 0)[x] = 1.0f;  // and 0 in the history
    }
    RunContext context{arena(), {}};
    ASSERT_TRUE(accumulate(history, {.r0 = 0.0f}, {}, state, trust, context));
    const std::array<float, 4> expected{0.25f, 1.0f, 0.0f, 0.25f};
    for (std::uint32_t x = 0; x < width; ++x) {
        EXPECT_NEAR(state.color.row(OwnWeightComponent, 0)[x], expected[x], 1e-6f) << x;
        EXPECT_EQ(state.color.row(OwnWeightComponent, 0)[x], state.color.row(0, 0)[x]) << x;
    }
}

// The noise of U - F relative to that of U, measured.
TEST(Signal, SelfWeightsGiveTheNoiseThatIsLeft) {
    const std::uint32_t size = 128;
    const Guides guides = flat(size, size);
    Settings settings;
    settings.stops = {.sigma_n = 1.0f, .sigma_d = 1e9f, .sigma_l = 1e12f};
    settings.order = LevelOrder::Fine;
    RunContext context{arena(), {}};
    for (const std::uint32_t levels : {0u, 1u, 2u}) {
        settings.levels = levels;
        Signal signal;
        signal.fit(size, size);
        State& state = signal.now();
        std::ranges::fill(state.moments.plane(Age), 16.0f);
        std::ranges::fill(state.moments.plane(SampleVariance), 15.0f / 12.0f);  // 1 / 12 of the mean
        for (std::uint32_t y = 0; y < size; ++y) {
            for (std::uint32_t c = 0; c < 3; ++c) {
                for (std::uint32_t x = 0; x < size; ++x) state.color.row(c, y)[x] = uniform(13, x, y);
            }
            std::fill_n(state.color.row(OwnWeightComponent, y), size, 1.0f);
        }
        Report report;
        ASSERT_TRUE(signal.filter(guides, settings, false, report, context));
        std::vector<float> weights(std::size_t{size} * size);
        signal.self_weights(weights);
        double left = 0.0, count = 0.0;
        for (std::uint32_t y = 8; y + 8 < size; ++y) {
            for (std::uint32_t x = 8; x + 8 < size; ++x) {
                left += std::pow(double(state.color.row(0, y)[x]) - signal.filtered().row(0, y)[x], 2.0);
                count += 1.0;
            }
        }
        EXPECT_NEAR(1.0 - weights[std::size_t{64} * size + 64], left / count * 12.0, 0.03) << levels;
    }
}

TEST(Wavelet, OtherSurfacesHaveNoWeight) {  // DT14
    const std::uint32_t width = 128, height = 64;
    const auto split = [&](const std::function<void(Guides&, std::uint32_t, std::uint32_t)>& other,
                           float brightness) {
        Guides guides = flat(width, height);
        for (std::uint32_t y = 0; y < height; ++y) {
            for (std::uint32_t x = 64; x < width; ++x) other(guides, x, y);
        }
        const auto picture = picture_of(
            width, height, [&](auto x, auto y) { return uniform(2, x, y) + (x >= 64 ? brightness : 0.0f); },
            [](auto, auto) { return 100.0f; });
        return transform(guides, {.sigma_l = 1e9f}, DundrOrder, picture);
    };
    const auto turned = [](Guides& guides, std::uint32_t x, std::uint32_t y) {
        guides.normal.row(0, y)[x] = 1.0f;
        guides.normal.row(2, y)[x] = 0.0f;
    };
    const auto another = [&](Guides& guides, std::uint32_t x, std::uint32_t y) {
        guides.ids[std::size_t{y} * width + x] = 2;
    };
    const auto far = [](Guides& guides, std::uint32_t x, std::uint32_t y) {
        guides.inverse_depth.row(0, y)[x] = 0.5f;
    };
    for (const auto& other : {std::function<void(Guides&, std::uint32_t, std::uint32_t)>(turned),
                              std::function<void(Guides&, std::uint32_t, std::uint32_t)>(another),
                              std::function<void(Guides&, std::uint32_t, std::uint32_t)>(far)}) {
        const PaddedPlanes dark = split(other, 0.0f), bright = split(other, 1000.0f);
        for (std::uint32_t y = 0; y < height; ++y) {
            for (std::uint32_t x = 0; x < 64; ++x) EXPECT_EQ(dark.row(0, y)[x], bright.row(0, y)[x]);
        }
    }
}

TEST(Wavelet, WeightsAreSymmetric) {
    // The weights of a pair are equal in both directions, so no energy is lost between two isolated pixels.
    const std::uint32_t width = 2, height = 1;
    const Guides guides = flat(width, height);
    const auto picture = picture_of(
        width, height, [](auto x, auto) { return x == 0 ? 1.0f : 3.0f; },
        [](auto x, auto) { return x == 0 ? 0.01f : 4.0f; });
    const PaddedPlanes out = transform(guides, {}, {0}, picture);
    EXPECT_NEAR(out.row(0, 0)[0] + out.row(0, 0)[1], 4.0f, 1e-5);
    EXPECT_GT(out.row(0, 0)[0], 1.0f);
}

// DT11: a level that loses taps at an edge distorts a ramp of light there. After the level of step 32 the
// distortion is a new edge 32 pixels away, unless finer levels follow.
TEST(Wavelet, CoarseLevelsFirstRepeatNoEdges) {
    const std::uint32_t width = 256, height = 8;
    Guides guides = flat(width, height);
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 160; x < width; ++x) guides.ids[std::size_t{y} * width + x] = 2;
    }
    const auto ramp = picture_of(
        width, height, [](auto x, auto) { return 0.01f * static_cast<float>(x); },
        [](auto, auto) { return 1.0f; });
    const auto repeated = [&](const std::vector<std::uint32_t>& levels) {
        const PaddedPlanes out = transform(guides, Open, levels, ramp);
        float most = 0.0f;
        for (std::uint32_t x = 100; x < 150; ++x) {
            const float* row = out.row(0, 4);
            most = std::max(most, std::fabs(row[x + 1] - 2.0f * row[x] + row[x - 1]));
        }
        return most;
    };
    const float dundr = repeated(DundrOrder), increasing = repeated({0, 1, 2, 3, 4, 5});
    EXPECT_GT(increasing, 0.05f);  // of a slope of 0.01
    EXPECT_LT(dundr, 0.2f * increasing);
}

std::vector<std::uint32_t> ordered_levels(std::uint32_t count, LevelOrder order) {
    std::vector<std::uint32_t> levels;
    for (std::uint32_t pass = 0; pass < pass_count(count, order); ++pass)
        levels.push_back(level_of(pass, count, order));
    return levels;
}

TEST(Wavelet, LevelsOfEachOrder) {
    using Levels = std::vector<std::uint32_t>;
    EXPECT_EQ(ordered_levels(6, LevelOrder::BothEnds), (Levels{0, 5, 4, 3, 2, 1, 0}));
    EXPECT_EQ(ordered_levels(6, LevelOrder::FirstThenCoarse), DundrOrder);
    EXPECT_EQ(ordered_levels(6, LevelOrder::Fine), (Levels{0, 1, 2, 3, 4, 5}));
    EXPECT_EQ(ordered_levels(6, LevelOrder::Coarse), (Levels{5, 4, 3, 2, 1, 0}));
    for (const LevelOrder order : {LevelOrder::BothEnds, LevelOrder::FirstThenCoarse}) {
        EXPECT_EQ(ordered_levels(0, order), Levels{});
        EXPECT_EQ(ordered_levels(1, order), Levels{0});
    }
}

// A pixel that has found rare light, on a surface where no other has: their variance is 0.
PaddedPlanes spread_find(LevelOrder order, Pair pair) {
    const auto is_find = [](auto x, auto y) { return x == 50 && y == 50; };
    return transform(flat(101, 101), {.sigma_d = 1e9f, .pair = pair}, ordered_levels(6, order),
                     picture_of(
                         101, 101, [&](auto x, auto y) { return is_find(x, y) ? 100.0f : 1.0f; },
                         [&](auto x, auto y) { return is_find(x, y) ? 9900.0f : 0.0f; }));
}

float brightest(const PaddedPlanes& picture) {
    float most = 0.0f;
    for (std::uint32_t y = 0; y < picture.height(); ++y)
        most = std::max(most, *std::max_element(picture.row(0, y), picture.row(0, y) + picture.width()));
    return most;
}

TEST(Wavelet, SpreadsALoneBrightFindAndKeepsItsLight) {
    const PaddedPlanes spread = spread_find(LevelOrder::BothEnds, Pair::Larger);
    EXPECT_LT(brightest(spread), 1.2f);
    EXPECT_GT(brightest(spread_find(LevelOrder::BothEnds, Pair::Smaller)), 50.0f);
    double light = 0.0;
    for (std::uint32_t y = 0; y < 101; ++y) {
        for (std::uint32_t x = 0; x < 101; ++x) light += spread.row(0, y)[x];
    }
    EXPECT_NEAR(light / (101.0 * 101.0 + 99.0), 1.0, 0.01);
}

TEST(Wavelet, LeavesNoDotsTwoPixelsApart) {
    const auto dots = [](LevelOrder order) {  // light of even rows and columns over that of odd ones
        const PaddedPlanes spread = spread_find(order, Pair::Larger);
        double even = 0.0, odd = 0.0;
        for (std::uint32_t y = 40; y < 60; ++y) {
            for (std::uint32_t x = 40; x < 60; ++x) {
                const double found = double(spread.row(0, y)[x]) - 1.0;
                if (x % 2 == 0 && y % 2 == 0) even += found;
                if (x % 2 == 1 && y % 2 == 1) odd += found;
            }
        }
        return even / odd;
    };
    EXPECT_NEAR(dots(LevelOrder::BothEnds), 1.0, 0.25);
    EXPECT_GT(dots(LevelOrder::FirstThenCoarse), 1.5);
}

TEST(Variance, IsSpatialForYoungPixels) {
    const std::uint32_t size = 64;
    Guides guides = flat(size, size);
    for (std::uint32_t y = 0; y < size; ++y) {
        for (std::uint32_t x = 32; x < size; ++x) guides.ids[std::size_t{y} * size + x] = 2;
    }
    State state{.moments = Planes(size, size, MomentCount)};
    state.color.fit(size, size, SignalComponents);
    for (std::uint32_t y = 0; y < size; ++y) {
        for (std::uint32_t x = 0; x < size; ++x) {
            const bool left = x < 32;
            state.moments.row(MeanLuminance, y)[x] = left ? uniform(7, x, y) : 100.0f;
            state.moments.row(Age, y)[x] = 1.0f;
        }
    }
    SpatialVariance variance;
    RunContext context{arena(), {}};
    ASSERT_TRUE(variance.run(guides, {}, 4.0f, false, state, context));
    double sum = 0.0;
    for (std::uint32_t y = 4; y < 60; ++y) {
        for (std::uint32_t x = 4; x < 28; ++x) sum += state.color.row(3, y)[x];
    }
    EXPECT_NEAR(sum / (56 * 24), 1.0 / 12.0, 0.01);        // of uniform numbers
    EXPECT_NEAR(state.color.row(3, 30)[40], 0.0f, 1e-2f);  // constant; the other side has no weight
    std::ranges::fill(state.moments.plane(Age), 16.0f);
    std::ranges::fill(state.moments.plane(SampleVariance), 3.0f);
    ASSERT_TRUE(variance.run(guides, {}, 4.0f, false, state, context));
    EXPECT_NEAR(state.color.row(3, 30)[10], 3.0f / 15.0f, 1e-5f);  // the pixel's own
    state.moments.row(SampleVariance, 30)[10] = 15.0f;
    for (const bool blurs : {false, true}) {  // (1 2 1)x(1 2 1)/16
        ASSERT_TRUE(variance.run(guides, {}, 4.0f, blurs, state, context));
        EXPECT_NEAR(state.color.row(3, 30)[10], blurs ? (4.0f + 12.0f * 0.2f) / 16.0f : 1.0f, 1e-5f);
        EXPECT_NEAR(state.color.row(3, 31)[11], blurs ? (1.0f + 15.0f * 0.2f) / 16.0f : 0.2f, 1e-5f);
    }
}

TEST(Holes, AreFilledFromNeighbours) {  // DT21
    const std::uint32_t width = 160, height = 90;
    Planes counts(width, height, 1), values(width, height, 2);
    std::vector<std::uint32_t> ids(std::size_t{width} * height);
    const auto plane_at = [](std::uint32_t x, std::uint32_t y) { return 1.0f + 0.01f * x + 0.02f * y; };
    const auto id_at = [](std::uint32_t x) { return x < 80 ? 1u : 2u; };
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            if (uniform(9, x, y) < 0.9f) continue;
            counts.row(0, y)[x] = 1.0f;
            ids[std::size_t{y} * width + x] = id_at(x);
            values.row(0, y)[x] = plane_at(x, y);
            values.row(1, y)[x] = static_cast<float>(id_at(x));  // constant on each object
        }
    }
    const std::vector<PlaneView> views{{values.row(0, 0), width}, {values.row(1, 0), width}};
    RunContext context{arena(), {}};
    HoleFill fill;
    ASSERT_TRUE(fill.run(counts, ids, views, context));
    const float range = plane_at(width, height) - plane_at(0, 0);
    double error = 0.0, wrong = 0.0;
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::uint32_t id = ids[std::size_t{y} * width + x];
            ASSERT_TRUE(id == 1 || id == 2) << x << " " << y;
            EXPECT_NEAR(values.row(1, y)[x], static_cast<float>(id), 1e-6);
            error += std::abs(values.row(0, y)[x] - plane_at(x, y)) / range;
            wrong += id != id_at(x) ? 1.0 : 0.0;
        }
    }
    EXPECT_LT(error / (width * height), 0.01);
    EXPECT_LT(wrong, 3.0 * height);  // at most some pixels next to the edge
}

}  // namespace
}  // namespace tessera::filter::svgf
