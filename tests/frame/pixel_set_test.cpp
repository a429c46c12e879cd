#include "mediator/frame/pixel_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "mediator/base/random.h"

namespace tessera::frame {
namespace {

std::vector<std::uint32_t> random_indices(std::size_t pixels, CounterRandom& random) {
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i < pixels; ++i) {
        if (random.below(3) == 0) indices.push_back(i);
    }
    if (indices.empty()) indices.push_back(static_cast<std::uint32_t>(random.below(pixels)));
    return indices;
}

TEST(PixelSet, SurvivesItsBits) {
    CounterRandom random(5);
    for (const std::size_t pixels : {2u, 7u, 8u, 9u, 64u, 1023u, 1024u}) {
        for (int i = 0; i < 20; ++i) {
            const PixelSet set(random_indices(pixels, random), pixels);
            const std::string bits = set.bits(pixels);
            EXPECT_EQ(bits.size(), set.is_all() ? 0 : (pixels + 7) / 8);
            const auto again = PixelSet::from_bits(bits, pixels);
            ASSERT_TRUE(again);
            EXPECT_EQ(*again, set);
            EXPECT_EQ(again->count(pixels), set.count(pixels));
        }
    }
}

TEST(PixelSet, OfAllPixelsHasOneForm) {
    const PixelSet all({0, 1, 2, 3}, 4);
    EXPECT_TRUE(all.is_all());
    EXPECT_EQ(all, PixelSet{});
    EXPECT_TRUE(all.bits(4).empty());
    EXPECT_EQ(all.count(4), 4u);
    EXPECT_EQ(all.index(3), 3u);
    EXPECT_NE(all, PixelSet({0, 1, 2}, 4));
}

TEST(PixelSet, RefusesBitsThatDoNotFitTheTile) {
    const auto refused = [](std::initializer_list<unsigned char> bytes, std::size_t pixels) {
        const std::string bits(bytes.begin(), bytes.end());
        return !PixelSet::from_bits(bits, pixels);
    };
    EXPECT_FALSE(refused({}, 10));
    EXPECT_FALSE(refused({1, 2}, 10));
    EXPECT_TRUE(refused({1}, 10)) << "too short";
    EXPECT_TRUE(refused({1, 0, 0}, 10)) << "too long";
    EXPECT_TRUE(refused({0, 0}, 10)) << "no pixel";
    EXPECT_TRUE(refused({0, 4}, 10)) << "a pixel beyond the end";
    EXPECT_TRUE(refused({255, 3}, 10)) << "all pixels have no bits";
}

}  // namespace
}  // namespace tessera::frame
