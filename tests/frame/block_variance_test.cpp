// Errors of means from the halves of blocks of samples.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "mediator/base/random.h"
#include "mediator/frame/block_stack.h"
#include "mediator/frame/design_effect.h"
#include "mediator/frame/merge.h"
#include "mediator/frame/resolve.h"
#include "mediator/shading/sampler.h"

namespace tessera::frame {
namespace {

constexpr ChannelSet Channels{Channel::Radiance, Channel::BlockVariance, Channel::FirstHalf};
constexpr std::array Weights{0.2126, 0.7152, 0.0722};

using Rgb = std::array<float, 3>;
using Draw = std::function<Rgb(std::uint32_t pixel, std::uint64_t sample)>;

std::vector<float> design_effect(const FilmTile& film) {
    DesignEffect effect;
    const std::span<const float> all = effect.measure(film);
    return {all.begin(), all.end()};
}

// The film of samples [0, n), merged as by a node and a master.
FilmTile film_of(std::int32_t width, std::int32_t height, std::uint64_t n, const Draw& draw) {
    const Rect rect{0, 0, width, height};
    BlockStack stack;
    for (std::uint64_t i = 0; i < n; ++i) {
        FilmTile tile = stack.recycled(rect, {i, 0}, Channels);
        for (std::uint32_t pixel = 0; pixel < tile.pixel_count(); ++pixel)
            put_sample(tile, pixel, draw(pixel, i));
        stack.push(std::move(tile));
    }
    std::vector<FilmTile> roots = stack.take();
    FilmTile film = roots.empty() ? FilmTile(rect, {}, Channels) : std::move(roots.front());
    for (std::size_t i = 1; i < roots.size(); ++i) merge(film, roots[i]);
    return film;
}

double top_of(const FilmTile& film, std::size_t pixel) {
    return film.plane(film.channels.first_plane(Channel::BlockVariance))[pixel];
}
double below_of(const FilmTile& film, std::size_t pixel) {
    return film.plane(film.channels.first_plane(Channel::BlockVariance) + 1)[pixel];
}
// Variance of the mean of independent samples, weighted as the squares above.
double independent_of(const FilmTile& film, std::size_t pixel) {
    const Image variance = resolve_variance_of_mean(film, Channel::Radiance);
    double sum = 0.0;
    for (std::size_t c = 0; c < 3; ++c) sum += Weights[c] * double(variance.values[3 * pixel + c]);
    return sum;
}

Rgb random_color(std::uint32_t pixel, std::uint64_t sample) {
    CounterRandom random(pixel, sample);
    const double shared = random.uniform();
    return {static_cast<float>(shared), static_cast<float>(shared * random.uniform()),
            static_cast<float>(-std::log(1.0 - random.uniform()))};
}

// By the means of the samples [first, first + count) in double precision.
double squared_half_difference(std::uint32_t pixel, std::uint64_t first, std::uint64_t count) {
    double sum = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
        double difference = 0.0;
        for (std::uint64_t i = 0; i < count; ++i) {
            const double value = random_color(pixel, first + i)[c];
            difference += (i < count / 2 ? value : -value) / double(count / 2);
        }
        sum += Weights[c] * difference * difference / 4.0;
    }
    return sum;
}

TEST(BlockVariance, IsTheSquaredHalfDifferenceOfTheHalves) {
    for (std::uint64_t n = 2; n <= 256; n *= 2) {
        const FilmTile film = film_of(4, 1, n, random_color);
        for (std::uint32_t pixel = 0; pixel < 4; ++pixel) {
            EXPECT_NEAR(top_of(film, pixel), squared_half_difference(pixel, 0, n), 1e-6) << n;
            const double below = n < 4 ? 0.0
                                       : 0.5 * (squared_half_difference(pixel, 0, n / 2) +
                                                squared_half_difference(pixel, n / 2, n / 2));
            EXPECT_NEAR(below_of(film, pixel), below, 1e-6) << n;
        }
    }
}

TEST(BlockVariance, OfTwoSamplesIsThatOfIndependentOnes) {
    const FilmTile film = film_of(16, 1, 2, random_color);
    for (std::size_t pixel = 0; pixel < 16; ++pixel)
        EXPECT_NEAR(top_of(film, pixel), independent_of(film, pixel), 1e-6);
}

// For any number of samples, also those that are no power of two, and where samples are rejected.
TEST(BlockVariance, IsUnbiasedForIndependentSamples) {
    constexpr std::int32_t Edge = 64;
    for (const bool rejects : {false, true}) {
        const auto draw = [&](std::uint32_t pixel, std::uint64_t sample) {
            const bool is_rejected = rejects && mix(mix(pixel) ^ sample) % 3 == 0;
            return is_rejected ? Rgb{std::numeric_limits<float>::quiet_NaN(), 0.0f, 0.0f}
                               : random_color(pixel, sample);
        };
        for (const std::uint64_t n : {2u, 3u, 4u, 5u, 7u, 12u, 13u, 31u, 64u}) {
            const FilmTile film = film_of(Edge, Edge, n, draw);
            const Image variance = resolve_variance_of_mean(film, Channel::Radiance);
            double sum = 0.0, squares = 0.0, pixels = 0.0;
            for (std::size_t i = 0; i < film.pixel_count(); ++i) {
                if (film.counts[i] < 2) continue;
                double difference = top_of(film, i);
                for (std::size_t c = 0; c < 3; ++c)
                    difference -= Weights[c] * double(variance.values[3 * i + c]);
                sum += difference;
                squares += difference * difference;
                ++pixels;
            }
            EXPECT_LT(std::fabs(sum), 4.5 * std::sqrt(squares)) << n << (rejects ? ", some rejected" : "");
            EXPECT_GT(pixels, 1000.0);
        }
    }
}

// Blocks that are no siblings have errors of their own: the squares of their shares are the weights.
TEST(BlockVariance, OfSeveralRootsIsTheSumOfTheirs) {
    const FilmTile film = film_of(4, 1, 14, random_color);  // 8 + 4 + 2
    for (std::uint32_t pixel = 0; pixel < 4; ++pixel) {
        const double top = squared_half_difference(pixel, 0, 8) * 64.0 +
                           squared_half_difference(pixel, 8, 4) * 16.0 +
                           squared_half_difference(pixel, 12, 2) * 4.0;
        EXPECT_NEAR(top_of(film, pixel), top / 196.0, 1e-6);
    }
}

TEST(FirstHalf, IsTheMeanOfTheFirstHalf) {
    for (const std::uint64_t n : {1u, 2u, 3u, 4u, 6u, 7u, 64u, 96u}) {
        const FilmTile film = film_of(3, 1, n, random_color);
        const std::uint32_t first = film.channels.first_plane(Channel::FirstHalf);
        // The halves of the blocks of which n consists.
        std::vector<std::uint64_t> samples;
        for (const SampleBlock& block : aligned_blocks(0, n)) {
            for (std::uint64_t i = 0; i < block.count() / 2; ++i) samples.push_back(block.first + i);
        }
        for (std::uint32_t pixel = 0; pixel < 3; ++pixel) {
            EXPECT_EQ(film.plane(first + 3)[pixel], static_cast<float>(samples.size())) << n;
            for (std::uint32_t c = 0; c < 3; ++c) {
                double mean = 0.0;
                for (const std::uint64_t i : samples)
                    mean += double(random_color(pixel, i)[c]) / double(samples.size());
                EXPECT_NEAR(film.plane(first + c)[pixel], mean, 1e-6) << n;
            }
        }
    }
}

// Squared error of the means, of what M2 / (n (n - 1)) says it is, and of what it says times the design effect.
struct Sums {
    double truth = 0.0, independent = 0.0, stratified = 0.0;
};

Sums errors(std::uint64_t n, const Draw& draw, const std::function<double(std::uint32_t)>& mean) {
    constexpr std::int32_t Edge = 48;
    const FilmTile film = film_of(Edge, Edge, n, draw);
    const std::vector<float> effect = design_effect(film);
    const Image picture = resolve(film, Channel::Radiance),
                variance = resolve_variance_of_mean(film, Channel::Radiance);
    Sums sums;
    for (std::uint32_t i = 0; i < film.pixel_count(); ++i) {
        const double error = double(picture.values[3 * i]) - mean(i);
        sums.truth += error * error;
        sums.independent += double(variance.values[3 * i]);
        sums.stratified += double(variance.values[3 * i] * effect[i]);
    }
    return sums;
}

Rgb grey(double value) {
    const auto v = static_cast<float>(value);
    return {v, v, v};
}

// A half space of the square, as a shadow's edge over a light: the area of x + y < t.
double area_below(double t) {
    return t < 1.0 ? 0.5 * t * t : 1.0 - 0.5 * (2.0 - t) * (2.0 - t);
}

TEST(DesignEffect, IsThatOfAPenumbra) {
    const auto threshold = [](std::uint32_t pixel) { return 0.2 + 1.6 * ((pixel * 37u) % 997u) / 997.0; };
    const auto edge = [&](std::uint32_t pixel, std::uint64_t sample) {
        const shading::vec2 u = shading::sample_pair(shading::make_sampler(pixel, 3, 1, sample), 0);
        return grey(double(u.x) + double(u.y) < threshold(pixel) ? 1.0 : 0.0);
    };
    const auto truth = [&](std::uint32_t pixel) { return area_below(threshold(pixel)); };
    for (const std::uint64_t n : {4u, 16u, 64u, 256u}) {
        const Sums sums = errors(n, edge, truth);
        std::printf("%llu samples: estimate over truth %.2f, as if independent %.2f\n",
                    static_cast<unsigned long long>(n), sums.stratified / sums.truth,
                    sums.independent / sums.truth);
        EXPECT_GT(sums.stratified, 0.8 * sums.truth) << n;
        EXPECT_LT(sums.stratified, 1.8 * sums.truth) << n;
        EXPECT_GT(sums.independent, (n < 16 ? 2.0 : 4.0) * sums.truth) << n;
    }
}

TEST(DesignEffect, OfIndependentSamplesIsNearlyOne) {
    const auto draw = [](std::uint32_t pixel, std::uint64_t sample) {
        return grey(-std::log(1.0 - CounterRandom(pixel, sample).uniform()));
    };
    for (const std::uint64_t n : {4u, 16u, 64u}) {
        const Sums sums = errors(n, draw, [](std::uint32_t) { return 1.0; });
        std::printf("%llu independent samples: design effect %.3f\n", static_cast<unsigned long long>(n),
                    sums.stratified / sums.independent);
        EXPECT_GT(sums.stratified, 0.92 * sums.independent) << n;
        EXPECT_LE(sums.stratified, sums.independent) << n;
    }
}

// Counts that floats round.
TEST(BlockVariance, OfBlocksOfABillionSamplesIsExact) {
    constexpr std::uint32_t Count = (1u << 30) - 1;
    FilmTile a({0, 0, 1, 1}, {0, 30}, Channels), b({0, 0, 1, 1}, {std::uint64_t{1} << 30, 30}, Channels);
    a.counts = {Count};
    b.counts = {Count};
    for (std::uint32_t c = 0; c < 3; ++c) {
        a.plane(c)[0] = 1.0f;
        b.plane(c)[0] = 1.5f;
        a.plane(3 + c)[0] = b.plane(3 + c)[0] = 1e9f;
    }
    merge(a, b);
    EXPECT_EQ(a.counts[0], 2 * Count);
    EXPECT_FLOAT_EQ(static_cast<float>(top_of(a, 0)), 0.0625f);
    EXPECT_EQ(a.plane(a.channels.first_plane(Channel::FirstHalf))[0], 1.0f);
    for (const float effect : design_effect(a)) EXPECT_EQ(effect, 1.0f);
}

// One pixel has nearly all of the variance, and its two finds happen to be in both halves of its samples.
TEST(DesignEffect, IsNotSmallByTheChanceOfOnePixel) {
    constexpr std::uint32_t Width = 21, Middle = 10 * Width + 10;
    const FilmTile film = film_of(Width, Width, 16, [](std::uint32_t pixel, std::uint64_t sample) {
        const bool found = pixel == Middle && (sample == 3 || sample == 11);
        return grey(found ? 1000.0 : CounterRandom(pixel, sample).uniform());
    });
    EXPECT_LT(top_of(film, Middle), 1.0);
    for (const float effect : design_effect(film)) EXPECT_GT(effect, 0.5f);
}

TEST(DesignEffect, IsOneWhereNothingIsKnown) {
    const auto all_ones = [](const FilmTile& film) {
        for (const float effect : design_effect(film)) {
            if (effect != 1.0f) return false;
        }
        return true;
    };
    EXPECT_TRUE(all_ones(film_of(9, 5, 0, random_color)));
    EXPECT_TRUE(all_ones(film_of(9, 5, 1, random_color)));
    EXPECT_TRUE(all_ones(film_of(9, 5, 16, [](auto, auto) { return grey(0.0); }))) << "all black";
    FilmTile without({0, 0, 9, 5}, {0, 0}, {Channel::Radiance});
    EXPECT_TRUE(all_ones(without));
}

TEST(DesignEffect, HasTheSameBitsOnAnyNumberOfThreads) {
    for (const auto& [width, height] : {std::pair{20, 130}, {9, 64}, {3, 2}}) {
        const FilmTile film = film_of(width, height, 16, random_color);
        const std::vector<float> alone = design_effect(film);
        tbb::task_arena arena(3);
        DesignEffect effect;
        const std::span<const float> all = effect.measure(film, &arena);
        EXPECT_TRUE(std::ranges::equal(all, alone)) << width << "x" << height;
    }
}

TEST(DesignEffect, IsFiniteAndPositiveOverTheWholeRangeOfFloats) {
    for (const double scale : {1e-30, 1e-10, 1e10, 1e18, 1e30}) {
        const auto draw = [&](std::uint32_t pixel, std::uint64_t sample) {
            return grey(scale * CounterRandom(pixel, sample).uniform());
        };
        for (const float effect : design_effect(film_of(20, 20, 16, draw))) {
            EXPECT_GT(effect, 0.0f) << scale;
            EXPECT_LE(effect, 1.0f) << scale;
        }
    }
}

// One bright pixel in the dark spoils the estimates within its window only.
TEST(DesignEffect, ABrightPixelIsAloneInItsWindow) {
    constexpr std::int32_t Edge = 32;
    const auto dark = [](std::uint32_t pixel, std::uint64_t sample) {
        return grey(1e-3 * CounterRandom(pixel, sample).uniform());
    };
    const auto lit = [&](std::uint32_t pixel, std::uint64_t sample) {
        return pixel == 16 * Edge + 16 && sample == 5 ? grey(1e6) : dark(pixel, sample);
    };
    const std::vector<float> without = design_effect(film_of(Edge, Edge, 16, dark)),
                             with = design_effect(film_of(Edge, Edge, 16, lit));
    for (std::int32_t y = 0; y < Edge; ++y) {
        for (std::int32_t x = 0; x < Edge; ++x) {
            const auto i = static_cast<std::size_t>(y * Edge + x);
            EXPECT_GT(with[i], 0.0f);
            const bool is_outside = std::abs(x - 16) > 4 || std::abs(y - 16) > 4;
            if (is_outside) {
                EXPECT_EQ(with[i], without[i]) << x << " " << y;
            }
        }
    }
}

}  // namespace
}  // namespace tessera::frame
