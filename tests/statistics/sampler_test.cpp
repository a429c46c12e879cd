#include "mediator/shading/sampler.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "mediator/shading/paths.h"
#include "tests/statistics/chi_squared.h"

namespace tessera::shading {
namespace {

using Four = std::array<float, 4>;
using Numbers = std::function<Four(std::uint64_t index)>;

Four all_of(const SampleSet& set) {
    const vec2 a = first_pair(set), b = second_pair(set);
    return {a.x, a.y, b.x, b.y};
}

Four four_at(std::uint32_t pixel, std::uint64_t index, std::uint32_t set) {
    return all_of(sample_set(make_sampler(pixel, 4, 99, index), set));
}

// The cell of a number if [0, 1) is divided into 2^bits.
std::uint32_t cell(float u, std::uint32_t bits) {
    return static_cast<std::uint32_t>(std::ldexp(u, static_cast<int>(bits)));
}

// Each of the 2^(a + b + c + d) boxes has exactly one of as many samples.
void expect_one_each(const Numbers& numbers, std::uint64_t first, const std::array<std::uint32_t, 4>& bits) {
    const std::uint32_t count = 1u << (bits[0] + bits[1] + bits[2] + bits[3]);
    std::vector<int> hits(count);
    for (std::uint64_t i = first; i < first + count; ++i) {
        const Four u = numbers(i);
        std::uint32_t box = 0;
        for (std::size_t d = 0; d < 4; ++d) box = (box << bits[d]) | cell(u[d], bits[d]);
        ASSERT_LT(box, count);
        ++hits[box];
    }
    for (const int hit : hits)
        ASSERT_EQ(hit, 1) << first << ": " << bits[0] << " " << bits[1] << " " << bits[2] << " " << bits[3];
}

// All splits of 4^m boxes over the four numbers; with them, each projection is stratified.
void expect_stratified(const Numbers& numbers, std::uint64_t block, std::uint32_t m) {
    const std::uint64_t first = block << (2 * m);
    for (std::uint32_t a = 0; a <= m; ++a) {
        for (std::uint32_t b = 0; a + b <= m; ++b) {
            for (std::uint32_t c = 0; a + b + c <= m; ++c)
                expect_one_each(numbers, first, {2 * a, 2 * b, 2 * c, 2 * (m - a - b - c)});
        }
    }
}

TEST(Sampler, FourNumbersAreStratifiedInBlocksOfPowersOfFour) {
    for (std::uint32_t set = 0; set < 3; ++set) {
        const auto numbers = [&](std::uint64_t index) { return four_at(17 + set, index, set); };
        for (std::uint32_t m = 1; m <= 4; ++m) {
            for (const std::uint64_t block : {0u, 1u, 7u, 1000u}) expect_stratified(numbers, block, m);
        }
        expect_stratified(numbers, 4, 5);
    }
}

TEST(Sampler, PairsAreStratifiedInBlocksOfPowersOfTwo) {
    const auto numbers = [](std::uint64_t index) { return four_at(17, index, 5); };
    for (std::uint32_t m = 1; m <= 9; ++m) {
        for (const std::uint64_t block : {0u, 1u, 6u, 1001u}) {
            for (std::uint32_t split = 0; split <= m; ++split) {
                expect_one_each(numbers, block << m, {split, m - split, 0, 0});
                expect_one_each(numbers, block << m, {0, 0, split, m - split});
            }
        }
    }
}

// The index has 64 bits: blocks on both sides of 2^32, and near the end.
TEST(Sampler, HighIndicesAreStratified) {
    const auto numbers = [](std::uint64_t index) { return four_at(3, index, 2); };
    constexpr std::uint64_t Blocks = std::uint64_t{1} << 26;  // of 4^3 samples, in 2^32
    for (const std::uint64_t block : {Blocks - 1, Blocks, (std::uint64_t{1} << 58) - 2})
        expect_stratified(numbers, block, 3);
}

TEST(Sampler, NumbersAreBelowOne) {
    EXPECT_LT(unit_float(0xffffffffu), 1.0f);
    EXPECT_EQ(unit_float(0xffu), 0.0f);
}

// One sample alone is uniform in four dimensions; so it is unbiased at any count.
TEST(Sampler, EachSampleIsUniformOverPixels) {
    constexpr std::uint32_t Pixels = 1u << 18, Bits = 2;
    for (const std::uint64_t index : {0u, 1u, 2u, 3u, 57u, 1024u}) {
        std::vector<double> observed(1u << (4 * Bits)),
            expected(observed.size(), double(Pixels) / double(observed.size()));
        for (std::uint32_t pixel = 0; pixel < Pixels; ++pixel) {
            std::uint32_t box = 0;
            for (const float u : four_at(pixel, index, 1)) box = (box << Bits) | cell(u, Bits);
            ++observed[box];
        }
        test::expect_fit(observed, expected);
    }
}

// Numbers of different sets, pixels and seeds do not depend on each other.
TEST(Sampler, SetsPixelsAndSeedsAreUncorrelated) {
    constexpr std::uint32_t Count = 1u << 18;
    std::array<double, 48> sums{};
    for (std::uint32_t i = 0; i < Count; ++i) {
        const auto numbers = [](std::uint32_t pixel, std::uint64_t seed, std::uint64_t index,
                                std::uint32_t set) {
            return all_of(sample_set(make_sampler(pixel, 9, seed, index), set));
        };
        const Four a = numbers(i, 7, 5, 1);
        const std::array<Four, 3> others{numbers(i, 7, 5, 2), numbers(i + 1, 7, 5, 1), numbers(i, 8, 5, 1)};
        for (std::size_t k = 0; k < sums.size(); ++k)
            sums[k] += (double(a[k % 4]) - 0.5) * (double(others[k / 16][k / 4 % 4]) - 0.5);
    }
    // Correlation has a standard deviation of 1 / sqrt(Count).
    for (const double sum : sums) EXPECT_LT(std::fabs(sum / Count * 12.0), 4.5 / std::sqrt(double(Count)));
}

// What the path tracer takes its numbers from. `mirrors` and `walls` precede the first rough vertex.
Path path_at(std::uint64_t index, std::uint32_t vertex, std::uint32_t mirrors, std::uint32_t walls) {
    Path path = start_path(make_sampler(12, 31, 5, index));
    path.vertex = vertex;
    path.speculars = mirrors;
    path.walls = walls;
    return path;
}

TEST(PathNumbers, PlaceInThePixelAndFirstPointOnALightAreStratifiedTogether) {
    for (const std::uint32_t mirrors : {0u, 2u}) {
        const auto numbers = [&](std::uint64_t index) -> Four {
            const Path path = path_at(index, mirrors + 1, mirrors, 1);
            const vec2 pixel = sample_pair(path.numbers, CameraSet);
            const vec4 light = light_numbers(path);
            return {pixel.x, pixel.y, light.z, light.w};
        };
        expect_stratified(numbers, 3, 4);
    }
}

TEST(PathNumbers, ChoiceOfALightAndPointOnItAreStratifiedTogether) {
    for (const std::uint32_t vertex : {1u, 2u, 30u}) {
        const auto numbers = [&](std::uint64_t index) -> Four {
            const vec4 light = light_numbers(path_at(index, vertex, 0, 0));
            return {light.x, light.y, light.z, light.w};
        };
        expect_stratified(numbers, 3, 4);
    }
}

TEST(PathNumbers, DirectionLobeAndRouletteAreStratifiedTogether) {
    for (const std::uint32_t vertex : {0u, 1u, 30u}) {
        const auto numbers = [&](std::uint64_t index) {
            return all_of(set_at(path_at(index, vertex, 0, 0), ScatterSet));
        };
        expect_stratified(numbers, 3, 4);
    }
}

// Variance of the mean of a function of four numbers, over pixels.
double variance_of_mean(const std::function<double(const Four&)>& f, std::uint32_t count, bool padded) {
    constexpr std::uint32_t Pixels = 500;
    double sum = 0.0, squares = 0.0;
    for (std::uint32_t pixel = 0; pixel < Pixels; ++pixel) {
        double mean = 0.0;
        for (std::uint32_t i = 0; i < count; ++i) {
            Four u = four_at(pixel, i, 0);
            if (padded) {
                const Four other = four_at(pixel, i, 1);
                u[2] = other[2];
                u[3] = other[3];
            }
            mean += f(u) / count;
        }
        sum += mean;
        squares += mean * mean;
    }
    return (squares - sum * sum / Pixels) / (Pixels - 1);
}

// Edges in any direction through the four numbers, as where a shadow's edge crosses a pixel. Two sets of two numbers leave
// their dependence to chance.
TEST(Sampler, FourNumbersTogetherHaveLessVarianceThanTwoPairs) {
    constexpr int Edges = 12;
    for (const auto& [count, least] : {std::pair{16u, 1.1}, std::pair{64u, 1.35}, std::pair{256u, 1.9}}) {
        CounterRandom random(11);
        double logarithms = 0.0;
        for (int k = 0; k < Edges; ++k) {
            Four normal{};
            for (float& n : normal) n = static_cast<float>(2.0 * random.uniform() - 1.0);
            const auto offset = static_cast<float>(0.4 * random.uniform() - 0.2);
            const auto edge = [&](const Four& u) {
                float distance = offset;
                for (std::size_t d = 0; d < 4; ++d) distance += normal[d] * (u[d] - 0.5f);
                return distance < 0.0f ? 1.0 : 0.0;
            };
            logarithms +=
                std::log(variance_of_mean(edge, count, true) / variance_of_mean(edge, count, false));
        }
        const double ratio = std::exp(logarithms / Edges);
        std::printf("%u samples: variance of two pairs over that of four numbers %.2f\n", count, ratio);
        EXPECT_GT(ratio, least);
    }
}

}  // namespace
}  // namespace tessera::shading
