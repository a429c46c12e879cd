#include "master/render/adaptive/step.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/master/adaptive/simulated_picture.h"

namespace tessera::master {
namespace {

// Calm but for a stripe and a corner.
float uneven(std::int32_t x, std::int32_t y, CounterRandom& random) {
    const double deviation = x < 8 && y < 8 ? 3.0 : y >= 40 && y < 48 ? 0.8 : 0.1;
    return static_cast<float>(1.0 + deviation * std::sqrt(12.0) * (random.uniform() - 0.5));
}

std::vector<bool> chosen(const Step& step, const std::vector<Rect>& tiles, std::int32_t width,
                         std::int32_t height) {
    std::vector<bool> result(static_cast<std::size_t>(width * height));
    for (const Round& round : step.rounds) {
        for (std::size_t i = 0; i < tiles.size(); ++i) {
            const RoundMask& mask = (*round.masks)[i];
            if (mask.pixels == 0) continue;
            const auto set = frame::PixelSet::from_bits(mask.bits, tiles[i].pixel_count());
            EXPECT_TRUE(set);
            EXPECT_EQ(set->count(tiles[i].pixel_count()), mask.pixels);
            for (std::size_t k = 0; k < mask.pixels; ++k) {
                const auto at = static_cast<std::int32_t>(set->index(k));
                const std::int32_t x = tiles[i].x + at % tiles[i].width, y = tiles[i].y + at / tiles[i].width;
                const auto pixel = static_cast<std::size_t>(y * width + x);
                EXPECT_FALSE(result[pixel]) << "twice";
                result[pixel] = true;
            }
        }
    }
    return result;
}

TEST(AdaptiveStep, ReachesTheNoiseWithFewerSamplesThanUniformSampling) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        constexpr double Wanted = 0.03;
        SimulatedPicture picture(64, 64, 32, uneven, 1000 * seed);
        const Step last = picture.finish({.noise = Wanted, .max_samples = 1 << 20});
        EXPECT_LE(last.noise, Wanted);
        EXPECT_GT(picture.true_noise() / Wanted, 0.6);
        EXPECT_LT(picture.true_noise() / Wanted, 1.2);
        // Uniform sampling needs the mean variance over the squared noise.
        const double mean_variance = (64 * 9.0 + 512 * 0.64 + (4096 - 576) * 0.01) / 4096.0;
        const double uniform = mean_variance / 1.01 / (Wanted * Wanted) * 4096.0;
        EXPECT_LT(double(picture.samples()), uniform / 1.5);
        EXPECT_EQ(picture.samples(), last.samples_expected);
    }
}

TEST(AdaptiveStep, ChoosesThePixelsThatNeedIt) {
    const SimulatedPicture picture(64, 64, 32, uneven);
    const Step step = picture.next({.noise = 0.05, .max_samples = 1 << 20});
    const std::vector<bool> is_chosen = chosen(step, picture.tiles(), 64, 64);
    std::size_t corner = 0, calm = 0;
    for (std::size_t i = 0; i < is_chosen.size(); ++i) {
        const std::size_t x = i % 64, y = i / 64;
        if (x < 8 && y < 8) corner += is_chosen[i];
        if (y < 30 && x > 16) calm += is_chosen[i];
    }
    EXPECT_EQ(corner, 64u);
    EXPECT_LT(double(calm) / (30 * 47), 0.1) << "but for the uniform part";
    EXPECT_GT(calm, 0u);
}

// Whatever the tiles.
TEST(AdaptiveStep, IsAFunctionOfTheFilm) {
    const SimulatedPicture small(70, 50, 16, uneven), large(70, 50, 64, uneven);
    const AdaptiveSettings settings{.noise = 0.02, .max_samples = 1 << 20, .step = 3};
    const Step a = small.next(settings), b = large.next(settings);
    EXPECT_EQ(a.noise, b.noise);
    EXPECT_EQ(a.samples_expected, b.samples_expected);
    EXPECT_EQ(chosen(a, small.tiles(), 70, 50), chosen(b, large.tiles(), 70, 50));
}

TEST(AdaptiveStep, OneEighthIsUniform) {
    const SimulatedPicture picture(64, 64, 32, uneven);
    std::vector<std::uint32_t> hits(64 * 64);
    for (std::uint32_t step = 0; step < 40; ++step) {
        const auto is_chosen = chosen(picture.next({.noise = 0.05, .max_samples = 1 << 20, .step = step}),
                                      picture.tiles(), 64, 64);
        for (std::size_t i = 0; i < hits.size(); ++i) hits[i] += is_chosen[i];
    }
    std::uint32_t always = 0, sometimes = 0, never = 0, uniform = 0;
    for (const std::uint32_t hit : hits) {
        (hit == 40 ? always : hit > 0 ? sometimes : never) += 1;
        if (hit < 40) uniform += hit;
    }
    EXPECT_NEAR(uniform / 40.0 / (uniform / 40.0 + always), 0.125, 0.01);
    EXPECT_LT(never, 100u) << "each pixel has its turn";
}

TEST(AdaptiveStep, SpendsTheSamplesThatThereAreWhereTheyAreNeeded) {
    constexpr std::uint64_t Pixels = 64 * 64;
    for (const std::uint64_t spp : {20u, 32u, 100u}) {
        SimulatedPicture picture(64, 64, 32, uneven);
        const Step last = picture.finish({.samples = spp * Pixels, .max_samples = 1 << 20});
        EXPECT_TRUE(last.rounds.empty());
        EXPECT_LE(picture.samples(), spp * Pixels);
        EXPECT_GE(picture.samples(), (spp - spp / 4) * Pixels);
        const frame::FilmTile film = picture.film();
        EXPECT_GE(film.counts[3 * 64 + 3], 8 * film.counts[60 * 64 + 60]) << "the corner";
    }
}

TEST(AdaptiveStep, MayDoubleAllPixels) {
    SimulatedPicture picture(64, 64, 32, uneven);
    const Step last = picture.finish({.noise = 0.05, .max_samples = 1 << 20, .uniform = true});
    EXPECT_LE(last.noise, 0.05);
    const auto [least, most] = std::ranges::minmax(picture.film().counts);
    EXPECT_EQ(least, most);
    SimulatedPicture black(32, 32, 16, [](auto, auto, CounterRandom&) { return 0.0f; });
    EXPECT_FALSE(black.next({.max_samples = 1 << 12, .uniform = true}).rounds.empty());
    EXPECT_TRUE(black.next({.noise = 0.1, .max_samples = 1 << 12, .uniform = true}).rounds.empty());
}

TEST(AdaptiveStep, RespectsTheMostSamplesAndClosedPixels) {
    SimulatedPicture picture(64, 64, 32, uneven);
    const AdaptiveSettings settings{.noise = 1e-6, .max_samples = 100};
    const Step last = picture.finish(settings);
    EXPECT_GT(last.noise, settings.noise);
    for (const std::uint32_t count : picture.film().counts) EXPECT_EQ(count, 64u);
    const SimulatedPicture fresh(64, 64, 32, uneven);
    std::vector<std::uint8_t> doublings = fresh.doublings();
    std::fill_n(doublings.begin(), 2048, std::uint8_t{255});
    const Step step = next_step(fresh.film(), doublings, fresh.tiles(), settings);
    const std::vector<bool> is_chosen = chosen(step, fresh.tiles(), 64, 64);
    for (std::size_t i = 0; i < is_chosen.size(); ++i) EXPECT_EQ(is_chosen[i], i >= 2048);
}

TEST(AdaptiveStep, EndsOnHardFilms) {
    const AdaptiveSettings settings{.noise = 0.01, .max_samples = 1 << 12};
    SimulatedPicture black(32, 32, 16, [](auto, auto, CounterRandom&) { return 0.0f; });
    EXPECT_TRUE(black.next(settings).rounds.empty());
    // One pixel needs all that it may have.
    SimulatedPicture one(32, 32, 16, [](std::int32_t x, std::int32_t y, CounterRandom& random) {
        return x == 20 && y == 11 && random.below(8) == 0 ? 1e4f : 1.0f;
    });
    one.finish({.noise = 0.001, .max_samples = 1 << 12});
    const std::vector<std::uint8_t> doublings = one.doublings();
    EXPECT_EQ(doublings[11 * 32 + 20], 12);
    // Samples that are not finite.
    SimulatedPicture damaged(32, 32, 16, [](std::int32_t x, std::int32_t, CounterRandom& random) {
        return x == 3 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(random.uniform());
    });
    const Step last = damaged.finish(settings);
    EXPECT_LE(last.noise, settings.noise);
    for (std::size_t y = 0; y < 32; ++y) EXPECT_EQ(damaged.doublings()[32 * y + 3], 4);
}

}  // namespace
}  // namespace tessera::master
