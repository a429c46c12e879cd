#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <tuple>
#include <vector>

#include "mediator/frame/block_stack.h"
#include "mediator/frame/film_tile.h"
#include "mediator/frame/merge.h"

// A film's float moments against a long-double reference that is fed the same float samples.
//
// Bounds, with u = 2^-24 the unit roundoff of float, d the deviation, r = |mean| / d, n = 2^k samples.
// Mean. A level of the tree computes (a + b) / 2: one rounding, of the sum, since halving is exact. A
// relative error of at most u per level averages over the siblings, so the error after k levels is at most k
// u |mean|, 20 u for k = 20, if all roundings have the same sign. They do not: roundings on one level are
// independent across the tree, and averaging 2^j of them divides their deviation by 2^(j/2). Only the last
// few levels count: the sum of u 2^(-j/2) / sqrt(3) over j >= 0 in quadrature is below u. 4 u leaves a factor
// for ties that happen to agree, and for samples of one size whose sums round alike. M2. A level adds (a -
// b)^2 n / 2. The means a and b carry errors of about u r d each (above), so:
//  - their squares add about (u r d)^2 n' per merge of n' samples: against M2 = n d^2 that is (u r)^2;
//  - the products with the true difference, of size d sqrt(2 / n'), add u r d * d sqrt(n'): against n d^2
//  that is
//    u r / sqrt(n) for the merges near the root, and the independent signs of the many below add to as much;
//  - the sums and products round by u relative per level, which decays like the mean's: about u.
// The factor 8 covers the levels that add up in each term.
namespace tessera::frame {
namespace {

constexpr double Epsilon = 1.0 / (1 << 24);
constexpr Rect OnePixel{0, 0, 1, 1};

struct Exact {
    long double mean = 0.0L, m2 = 0.0L;
};

Exact exact_moments(const std::vector<float>& samples) {
    Exact exact;
    for (const float sample : samples) exact.mean += sample;
    exact.mean /= static_cast<long double>(samples.size());
    for (const float sample : samples) {
        const long double difference = sample - exact.mean;
        exact.m2 += difference * difference;
    }
    return exact;
}

std::vector<float> normal_samples(std::size_t count, double mean, double deviation, unsigned seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> distribution(mean, deviation);
    std::vector<float> samples(count);
    for (float& sample : samples) sample = static_cast<float>(distribution(random));
    return samples;
}

// As a back-end makes it: one block of one sample after another.
FilmTile film_of(const std::vector<float>& samples) {
    BlockStack stack;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        FilmTile tile = stack.recycled(OnePixel, {i, 0}, {Channel::Radiance});
        put_sample(tile, 0, std::array{samples[i], -samples[i], 0.5f});
        stack.push(std::move(tile));
    }
    std::vector<FilmTile> blocks = stack.take();
    FilmTile film = std::move(blocks.front());
    for (std::size_t i = 1; i < blocks.size(); ++i) merge(film, blocks[i]);
    return film;
}

class FilmMoments : public testing::TestWithParam<std::tuple<int, double>> {};

TEST_P(FilmMoments, StayWithinTheDerivedBounds) {
    const auto [level, r] = GetParam();
    const std::size_t n = std::size_t{1} << level;
    for (const unsigned seed : {1u, 2u, 3u}) {
        const std::vector<float> samples =
            normal_samples(n, r, 1.0, seed + 100u * static_cast<unsigned>(level));
        const Exact exact = exact_moments(samples);
        const FilmTile film = film_of(samples);
        ASSERT_EQ(film.counts[0], n);
        // r of the samples as they are: rounding them to float has its own deviation at 1e6.
        const double measured_r = static_cast<double>(std::abs(exact.mean) / std::sqrt(exact.m2 / n));
        const double mean_error = static_cast<double>(std::abs((film.plane(0)[0] - exact.mean) / exact.mean));
        EXPECT_LE(mean_error, 4.0 * Epsilon) << "seed " << seed;
        const double er = Epsilon * measured_r;
        const double bound = 8.0 * (er * er + er / std::sqrt(static_cast<double>(n)) + Epsilon);
        EXPECT_LE(static_cast<double>(std::abs(film.plane(3)[0] - exact.m2) / exact.m2), bound)
            << "seed " << seed;
        EXPECT_EQ(film.plane(1)[0], -film.plane(0)[0]);
        EXPECT_EQ(film.plane(4)[0], film.plane(3)[0]);
        EXPECT_EQ(film.plane(2)[0], 0.5f);
        EXPECT_EQ(film.plane(5)[0], 0.0f);
    }
}

INSTANTIATE_TEST_SUITE_P(Hard, FilmMoments,
                         testing::Combine(testing::Values(10, 20),
                                          testing::Values(1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6)));
INSTANTIATE_TEST_SUITE_P(SixteenMillionSamples, FilmMoments,
                         testing::Combine(testing::Values(24), testing::Values(1.0, 1e3, 1e6)));

// Skewed as light is: few samples carry most of it.
TEST(FilmMoments, OfFirefliesStayWithinTheBounds) {
    std::mt19937_64 random(7);
    std::exponential_distribution<double> distribution(1.0);
    std::vector<float> samples(1 << 16);
    for (float& sample : samples) sample = static_cast<float>(std::pow(distribution(random), 6.0));
    const Exact exact = exact_moments(samples);
    const FilmTile film = film_of(samples);
    EXPECT_LE(static_cast<double>(std::abs(film.plane(0)[0] - exact.mean) / exact.mean), 4.0 * Epsilon);
    EXPECT_LE(static_cast<double>(std::abs(film.plane(3)[0] - exact.m2) / exact.m2), 8.0 * 2.0 * Epsilon);
}

TEST(DoubleMoments, KeepAccuracyWhereTheNaiveFormFails) {
    constexpr std::size_t N = 1 << 16;
    std::mt19937_64 random(11);
    std::normal_distribution<double> distribution(1e6, 1e-2);
    std::vector<Moments<double>> parts;
    long double sum = 0.0L, m2 = 0.0L;
    for (std::size_t i = 0; i < N; ++i) {
        parts.push_back({1, distribution(random), 0.0});
        sum += parts.back().mean;
    }
    for (const auto& part : parts) m2 += (part.mean - sum / N) * (part.mean - sum / N);
    for (std::size_t width = 1; width < N; width *= 2)
        for (std::size_t i = 0; i < N; i += 2 * width) parts[i] = merged(parts[i], parts[i + width]);
    EXPECT_NEAR(parts[0].mean / static_cast<double>(sum / N), 1.0, 1e-6);
    EXPECT_NEAR(parts[0].m2 / static_cast<double>(m2), 1.0, 1e-6);
    EXPECT_EQ(parts[0].n, N);
}

TEST(DoubleMoments, OfRandomUnequalPartsKeepAccuracy) {
    std::mt19937_64 random(12);
    std::normal_distribution<double> distribution(1e6, 1e-2);
    Moments<double> all;
    std::vector<double> samples;
    while (samples.size() < 20000) {
        Moments<double> part;
        const std::size_t count = random() % 40;
        for (std::size_t i = 0; i < count; ++i) {
            samples.push_back(distribution(random));
            part = merged(part, {1, samples.back(), 0.0});
        }
        all = merged(all, part);
    }
    long double sum = 0.0L, m2 = 0.0L;
    for (const double sample : samples) sum += sample;
    const long double mean = sum / static_cast<long double>(samples.size());
    for (const double sample : samples) m2 += (sample - mean) * (sample - mean);
    EXPECT_EQ(all.n, samples.size());
    EXPECT_NEAR(all.mean / static_cast<double>(mean), 1.0, 1e-6);
    EXPECT_NEAR(all.m2 / static_cast<double>(m2), 1.0, 1e-6);
}

TEST(Moments, MergingEmptyMomentsIsANoOp) {
    const Moments<float> some{3, 2.5f, 7.0f}, none{};
    for (const auto& both : {merged(some, none), merged(none, some)}) {
        EXPECT_EQ(both.n, 3u);
        EXPECT_EQ(both.mean, 2.5f);
        EXPECT_EQ(both.m2, 7.0f);
    }
    EXPECT_EQ(merged(none, none).n, 0u);
    EXPECT_EQ(merged(none, none).m2, 0.0f);
}

TEST(Moments, OfTwoSingleSamplesAreExact) {
    const auto both = merged<float>({1, 3.0f, 0.0f}, {1, 7.0f, 0.0f});
    EXPECT_EQ(both.n, 2u);
    EXPECT_EQ(both.mean, 5.0f);
    EXPECT_EQ(both.m2, 8.0f);
}

TEST(Moments, OfUnequalCountsFollowTheGeneralForm) {
    // {1, 2, 3} and {10}: mean 4, M2 = 9 + 4 + 1 + 36.
    const auto both = merged<float>({3, 2.0f, 2.0f}, {1, 10.0f, 0.0f});
    EXPECT_EQ(both.n, 4u);
    EXPECT_FLOAT_EQ(both.mean, 4.0f);
    EXPECT_FLOAT_EQ(both.m2, 50.0f);
}

// A pixel that lost samples makes its whole tile take the general form: its neighbours must not notice.
TEST(FilmMoments, UnequalCountsInOnePixelDoNotAffectOthers) {
    const Rect two{0, 0, 2, 1};
    const auto tile = [&](std::uint64_t sample, float left, float right) {
        FilmTile made(two, {sample, 0}, {Channel::Radiance});
        put_sample(made, 0, std::array{left, left, left});
        put_sample(made, 1, std::array{right, right, right});
        return made;
    };
    std::mt19937 random(5);
    std::uniform_real_distribution<float> light(0.0f, 10.0f);
    for (int round = 0; round < 100; ++round) {
        const float a = light(random), b = light(random), c = light(random);
        FilmTile clean = tile(0, a, c), gap = tile(0, a, std::nanf(""));
        merge(clean, tile(1, b, c));
        merge(gap, tile(1, b, c));
        for (const std::uint32_t plane : {0u, 3u}) EXPECT_EQ(clean.plane(plane)[0], gap.plane(plane)[0]);
        EXPECT_EQ(gap.counts[1], 1u);
        EXPECT_EQ(gap.plane(0)[1], c);
        EXPECT_EQ(gap.nonfinite_samples, 1u);
    }
}

// Direct and indirect light of one sample each have their own: one with all the spread, the other with none.
TEST(FilmMoments, OfDisjointChannelsDoNotMix) {
    FilmTile film(OnePixel, {0, 0}, {Channel::LowVariance, Channel::HighVariance});
    FilmTile later(OnePixel, {1, 0}, {Channel::LowVariance, Channel::HighVariance});
    put_sample(film, 0, std::array{1.0f, 2.0f, 3.0f, 1e6f, 1e6f, 1e6f});
    put_sample(later, 0, std::array{3.0f, 2.0f, 1.0f, 1e6f, 1e6f, 1e6f});
    merge(film, later);
    const std::array<float, 12> expected{2, 2, 2, 2, 0, 2, 1e6f, 1e6f, 1e6f, 0, 0, 0};
    for (std::uint32_t plane = 0; plane < 12; ++plane)
        EXPECT_EQ(film.plane(plane)[0], expected[plane]) << plane;
}

}  // namespace
}  // namespace tessera::frame
