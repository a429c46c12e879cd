#include "mediator/picture/noise_map.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/master/adaptive/simulated_picture.h"

namespace tessera::master {
namespace {

using picture::NoiseMap;

// Uniform in an interval around 1 with this deviation.
SimulatedPicture::Sample uniform_noise(double deviation) {
    return [deviation](std::int32_t, std::int32_t, CounterRandom& random) {
        return static_cast<float>(1.0 + deviation * std::sqrt(12.0) * (random.uniform() - 0.5));
    };
}

TEST(Noise, IsTheRootOfRelMse) {
    for (const double deviation : {1e-3, 0.1, 0.5}) {
        for (const std::uint32_t level : {1u, 2u, 4u, 6u}) {
            const SimulatedPicture picture(64, 64, 32, uniform_noise(deviation), 3, level);
            const NoiseMap map(picture.film());
            const double expected = deviation / std::sqrt(1.01 * double(std::uint64_t{1} << level));
            EXPECT_NEAR(map.noise() / expected, 1.0, 0.06) << deviation << ", 2^" << level;
            EXPECT_NEAR(map.noise() / picture.true_noise(), 1.0, 0.08);
        }
    }
}

// A pixel is compared with its own brightness, not with that of its neighbours, wherever they differ by more than noise.
TEST(Noise, OfFineShadowsIsThatOfDarkPixels) {
    const auto light = [](std::int32_t x) { return x % 4 == 0 ? 0.1 : 1.0; };
    const SimulatedPicture picture(
        64, 64, 32,
        [&](std::int32_t x, std::int32_t, CounterRandom& random) {
            return static_cast<float>(light(x) + 0.2 * std::sqrt(12.0) * (random.uniform() - 0.5));
        },
        5);
    const double mean = 0.775, floor = 0.01 * mean * mean;
    const double expected = std::sqrt(0.04 / 16.0 * (0.25 / (0.01 + floor) + 0.75 / (1.0 + floor)));
    EXPECT_NEAR(NoiseMap(picture.film()).noise() / expected, 1.0, 0.1);
}

// Light that few samples find: they are compared with the brightness that is expected, not with what they found. (Each counted
// among its own neighbours, the estimate was a third of the noise.)
TEST(Noise, OfRareLightIsThatOfItsFinds) {
    double estimated = 0.0, expected = 0.0;
    constexpr double Chance = 1e-4, Light = 300.0;
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
        const SimulatedPicture picture(
            64, 64, 32,
            [&](std::int32_t, std::int32_t, CounterRandom& random) {
                return random.uniform() < Chance ? float(Light) : 0.5f;
            },
            seed);
        const double noise = NoiseMap(picture.film()).noise(), mean = 0.5 + Chance * Light;
        estimated += noise * noise;
        expected += Chance * Light * Light / 16.0 / (1.01 * mean * mean);
    }
    EXPECT_NEAR(std::sqrt(estimated / expected), 1.0, 0.25);
}

TEST(Noise, DoesNotDependOnTheScaleOfTheLight) {
    frame::FilmTile film = SimulatedPicture(32, 32, 32, uniform_noise(0.4)).film();
    const double noise = NoiseMap(film).noise();
    for (const float scale : {1e-10f, 1e10f}) {
        frame::FilmTile scaled = film;
        for (std::uint32_t c = 0; c < 3; ++c) {
            for (float& mean : scaled.plane(c)) mean *= scale;
            for (float& m2 : scaled.plane(3 + c)) m2 *= scale * scale;
        }
        for (std::uint32_t plane = 6; plane < 8; ++plane) {
            for (float& error : scaled.plane(plane)) error *= scale * scale;
        }
        EXPECT_NEAR(NoiseMap(scaled).noise() / noise, 1.0, 1e-3) << scale;
    }
}

TEST(Noise, IsZeroWithoutLightOrSamples) {
    const Rect rect{0, 0, 8, 8};
    frame::FilmTile film(rect, {0, 4}, SimulatedPicture::Channels);
    EXPECT_EQ(NoiseMap(film).noise(), 0.0) << "no samples";
    film.counts.assign(64, 16);
    EXPECT_EQ(NoiseMap(film).noise(), 0.0) << "black";
    film.counts.assign(64, 1);
    EXPECT_EQ(NoiseMap(film).noise(), 0.0) << "single samples say nothing";
}

TEST(Noise, StaysFiniteWithAnyValues) {
    frame::FilmTile film = SimulatedPicture(16, 16, 16, uniform_noise(0.1)).film();
    film.plane(0)[40] = 3e38f;
    film.plane(3)[40] = std::numeric_limits<float>::infinity();
    film.plane(6)[40] = std::numeric_limits<float>::infinity();
    film.plane(1)[90] = 1e6f;
    film.counts[91] = 0;
    film.counts[92] = 1;
    film.counts[93] = std::numeric_limits<std::uint32_t>::max();
    const NoiseMap map(film);
    EXPECT_TRUE(std::isfinite(map.noise()));
    for (const float value : map.deviations()) {
        EXPECT_TRUE(std::isfinite(value));
        EXPECT_GE(value, 0.0f);
    }
}

// However the rows are divided: also pictures lower than a band, or than what is averaged over.
TEST(Noise, HasTheSameBitsOnAnyNumberOfThreads) {
    for (const auto& [width, height] : {std::pair{131, 200}, {33, 17}, {5, 3}, {1, 70}, {70, 1}}) {
        frame::FilmTile film = SimulatedPicture(width, height, 32, uniform_noise(0.3)).film();
        for (std::size_t i = 0; i < film.pixel_count(); i += 7)
            film.counts[i] = static_cast<std::uint32_t>(i % 3);
        const NoiseMap alone(film);
        for (const int threads : {1, 2, 5}) {
            tbb::task_arena arena(threads);
            const NoiseMap map(film, &arena);
            EXPECT_EQ(map.noise(), alone.noise()) << width << "x" << height;
            EXPECT_EQ(map.deviations(), alone.deviations()) << width << "x" << height;
        }
    }
}

}  // namespace
}  // namespace tessera::master
