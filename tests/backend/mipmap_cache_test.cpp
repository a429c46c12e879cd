#include "mediator/backend/tables/mipmap_cache.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "mediator/base/random.h"

namespace tessera::backend {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct Picture {
    scene::Texture texture;
    scene::Blob texels;

    Picture(std::uint32_t width, std::uint32_t height, scene::TexelFormat format, const Bytes& bytes)
        : texture{.width = width, .height = height, .format = format},
          texels(std::as_bytes(std::span(bytes))) {}
    Bytes levels() const {
        const scene::BlobPtr mipmaps = make_mipmaps(texture, texels);
        const auto bytes = mipmaps->as<std::uint8_t>();
        return {bytes.begin(), bytes.end()};
    }
};

Bytes noise(std::size_t texels) {
    CounterRandom random(5);
    Bytes bytes;
    for (std::size_t i = 0; i < 4 * texels; ++i)
        bytes.push_back(static_cast<std::uint8_t>(random.below(256)));
    return bytes;
}

TEST(MipmapCache, MipLevelsGoDownToOneTexel) {
    EXPECT_EQ(level_count(1, 1), 0u);
    EXPECT_EQ(level_count(2, 1), 1u);
    EXPECT_EQ(level_count(5, 3), 2u);
    EXPECT_EQ(level_count(16384, 7), 14u);
    const Picture odd(5, 3, scene::TexelFormat::Rgba8, noise(15));
    EXPECT_EQ(odd.levels().size(), 4u * (2 * 1 + 1 * 1));
    const Picture square(64, 64, scene::TexelFormat::Rgba8, noise(64 * 64));
    EXPECT_LE(square.levels().size(), square.texels.bytes().size() / 3);
}

TEST(MipmapCache, EachTexelIsTheMeanOfTheTexelsItCovers) {
    const Bytes bytes = noise(8 * 4);
    const Bytes levels = Picture(8, 4, scene::TexelFormat::Rgba8, bytes).levels();
    for (std::uint32_t y = 0; y < 2; ++y) {
        for (std::uint32_t x = 0; x < 4; ++x) {
            for (std::uint32_t k = 0; k < 4; ++k) {
                const auto at = [&](std::uint32_t dx, std::uint32_t dy) {
                    return double(bytes[4 * ((2 * y + dy) * 8 + 2 * x + dx) + k]);
                };
                const double mean = (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) / 4;
                EXPECT_NEAR(levels[4 * (y * 4 + x) + k], mean, 0.5001);
            }
        }
    }
}

TEST(MipmapCache, OddSizesKeepTheMean) {
    const Bytes bytes = noise(7 * 5);
    const Bytes levels = Picture(7, 5, scene::TexelFormat::Rgba8, bytes).levels();
    for (std::size_t k = 0; k < 4; ++k) {
        double mean = 0.0;
        for (std::size_t i = k; i < bytes.size(); i += 4) mean += bytes[i] / 35.0;
        EXPECT_NEAR(levels[levels.size() - 4 + k], mean, 0.5001) << "the last texel is the mean of all";
    }
}

TEST(MipmapCache, SrgbIsAveragedInLinearSpace) {
    const Bytes bytes{255, 0, 0, 255, 0, 0, 0, 1};
    const Bytes levels = Picture(2, 1, scene::TexelFormat::Rgba8Srgb, bytes).levels();
    EXPECT_EQ(levels, (Bytes{188, 0, 0, 128})) << "half of the light, and half of the opacity as it is";
    const Bytes same(4 * 64, 77);
    for (const std::uint8_t value : Picture(8, 8, scene::TexelFormat::Rgba8Srgb, same).levels())
        EXPECT_EQ(value, 77);
}

TEST(MipmapCache, ComputesMipMapsOnceAndOnlyWhereTheyHelp) {
    Picture picture(4, 4, scene::TexelFormat::Rgba8, noise(16));
    MipmapCache mipmaps;
    const scene::BlobPtr first = mipmaps.levels(picture.texture, picture.texels);
    ASSERT_TRUE(first);
    mipmaps.drop_unused();
    EXPECT_EQ(mipmaps.levels(picture.texture, picture.texels), first);
    mipmaps.drop_unused();
    mipmaps.drop_unused();
    EXPECT_EQ(first.use_count(), 1) << "it was no longer used";
    picture.texture.filter = scene::TextureFilter::Nearest;
    EXPECT_FALSE(mipmaps.levels(picture.texture, picture.texels));
    const Picture dot(1, 1, scene::TexelFormat::Rgba8, noise(1));
    EXPECT_FALSE(mipmaps.levels(dot.texture, dot.texels));
    picture.texture.filter = scene::TextureFilter::Linear;
    picture.texture.format = scene::TexelFormat::RgbFloat;
    EXPECT_FALSE(mipmaps.levels(picture.texture, picture.texels));
}

}  // namespace
}  // namespace tessera::backend
