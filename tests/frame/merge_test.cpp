#include "mediator/frame/merge.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include "mediator/frame/resolve.h"
#include "tests/frame/film_fixture.h"

namespace tessera::frame {
namespace {

constexpr float Infinity = std::numeric_limits<float>::infinity();

FilmTile one_pixel(std::uint64_t sample, float radiance, float depth, std::uint32_t id) {
    FilmTile tile({0, 0, 1, 1}, {sample, 0}, {Channel::Radiance, Channel::Depth, Channel::ObjectIndex});
    const std::array<float, 6> values{radiance, radiance, radiance, depth, depth, std::bit_cast<float>(id)};
    put_sample(tile, 0, values);
    return tile;
}

std::uint32_t object_of(const FilmTile& film) {
    return std::bit_cast<std::uint32_t>(resolve(film, Channel::ObjectIndex).pixel(0)[1]);
}

TEST(Merge, KeepsTheNearestAndOnTiesTheEarlierSample) {
    FilmTile film = one_pixel(0, 1.0f, 5.0f, 11);
    merge(film, one_pixel(1, 3.0f, 5.0f, 22));
    EXPECT_EQ(object_of(film), 11u) << "the same depth: the lower sample index stays";
    FilmTile later = one_pixel(2, 1.0f, 4.0f, 33);
    merge(later, one_pixel(3, 1.0f, Infinity, 0));
    merge(film, later);
    EXPECT_EQ(object_of(film), 33u);
    EXPECT_EQ(resolve(film, Channel::Depth).values[0], 4.0f);
    EXPECT_EQ(film.block, (SampleBlock{0, 2}));
    EXPECT_EQ(film.counts[0], 4u);
}

TEST(Merge, CopiesIdsThatLookLikeANaNBitByBit) {
    FilmTile film = one_pixel(0, 1.0f, 5.0f, 1);
    merge(film, one_pixel(1, 1.0f, 1.0f, 0x7f800001u));
    EXPECT_EQ(object_of(film), 0x7f800001u);
}

TEST(Merge, ARejectedSampleOnlyIncrementsItsCounter) {
    const FilmTile rejected = one_pixel(1, std::numeric_limits<float>::quiet_NaN(), 5.0f, 2);
    EXPECT_EQ(rejected.nonfinite_samples, 1u);
    EXPECT_EQ(rejected.counts[0], 0u);
    FilmTile film = one_pixel(0, 2.0f, 7.0f, 1);
    merge(film, rejected);
    EXPECT_EQ(film.counts[0], 1u);
    EXPECT_EQ(resolve(film, Channel::Radiance).values[0], 2.0f);
    EXPECT_EQ(object_of(film), 1u) << "its depth and id are out, too";
    EXPECT_EQ(film.nonfinite_samples, 1u);
    FilmTile infinite = one_pixel(0, Infinity, 1.0f, 1);
    EXPECT_EQ(infinite.nonfinite_samples, 1u);
}

// What is asked for in addition changes nothing in the radiance, whatever its values are.
TEST(Merge, ValuesThatAreNotFiniteAreLeftOutChannelByChannel) {
    constexpr float NaN = std::numeric_limits<float>::quiet_NaN();
    const ChannelSet channels{Channel::Radiance, Channel::Albedo, Channel::Normal, Channel::Depth};
    const auto sample = [&](std::uint64_t index, float albedo, float normal, float depth) {
        FilmTile tile({0, 0, 1, 1}, {index, 0}, channels);
        put_sample(tile, 0, std::array{2.0f, 3.0f, 4.0f, 0.5f, albedo, 0.5f, 1.0f, normal, 0.0f, depth});
        return tile;
    };
    FilmTile film = sample(0, NaN, 1.0f, 7.0f);
    merge(film, sample(1, 0.25f, Infinity, NaN));
    EXPECT_EQ(film.counts[0], 2u);
    EXPECT_EQ(film.nonfinite_samples, 0u);
    EXPECT_EQ(resolve(film, Channel::Radiance).values[1], 3.0f);
    EXPECT_EQ(resolve(film, Channel::Albedo).values[1], 0.125f) << "one of two samples has none";
    EXPECT_EQ(resolve(film, Channel::Normal).values[0], 0.5f);
    EXPECT_EQ(resolve(film, Channel::Depth).values[0], 7.0f);
    EXPECT_EQ(resolve(sample(0, 1.0f, 1.0f, NaN), Channel::Depth).values[0], Infinity) << "as of a miss";
}

TEST(Resolve, HandlesNoneAndOneSample) {
    FilmTile empty({0, 0, 1, 1}, {0, 0}, {Channel::Radiance, Channel::Depth});
    EXPECT_EQ(resolve(empty, Channel::Radiance).values[0], 0.0f);
    EXPECT_EQ(resolve(empty, Channel::Depth).values[0], Infinity);
    EXPECT_EQ(resolve_variance_of_mean(empty, Channel::Radiance).values[0], 0.0f);
    FilmTile film = one_pixel(0, 1.0f, 1.0f, 1);
    EXPECT_EQ(resolve_variance_of_mean(film, Channel::Radiance).values[0], 0.0f);
    merge(film, one_pixel(1, 3.0f, 1.0f, 1));
    EXPECT_EQ(resolve(film, Channel::Radiance).values[0], 2.0f);
    EXPECT_EQ(resolve_variance_of_mean(film, Channel::Radiance).values[0],
              1.0f);  // M2 = 2, n = 2: 2 / (2 * 1)
}

TEST(FilmHash, DependsOnEveryBitAndEveryCount) {
    const FilmTile film = canonical_film({0, 2});
    const Hash256 hash = film_hash(film);
    for (std::size_t i = 0; i < film.planes.size(); i += 7) {
        FilmTile other = film;
        auto bits = std::bit_cast<std::uint32_t>(other.planes[i]) ^ 1u;
        std::memcpy(&other.planes[i], &bits, sizeof bits);
        EXPECT_NE(film_hash(other), hash);
    }
    FilmTile other = film;
    other.counts[3] += 1;
    EXPECT_NE(film_hash(other), hash);
}

}  // namespace
}  // namespace tessera::frame
