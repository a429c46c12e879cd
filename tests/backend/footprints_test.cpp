// Texture lookups with a footprint: interpolation between two mip levels.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "mediator/base/random.h"
#include "mediator/shading/textures.h"

namespace tessera::shading {
namespace {

// 16 x 8 texels and four levels. Each level is independent noise instead of the mean of the finer one, so that
// the level of a value is known.
struct Footprints : testing::Test {
    Footprints() {
        CounterRandom random(11);
        for (auto [count, texels] :
             {std::pair(16 * 8, &picture), std::pair(8 * 4 + 4 * 2 + 2 + 1, &levels)}) {
            for (int i = 0; i < count; ++i) texels->push_back(uint(random.bits() >> 32));
        }
        map.texels.items = picture.data();
        map.levels.items = levels.data();
    }
    static uint width_of(uint level) { return 16u >> level; }
    static uint height_of(uint level) { return std::max(8u >> level, 1u); }
    // Of a texel of a mip level; level 0 is the full size.
    vec4 texel(uint level, uint x, uint y) const {
        std::size_t first = 0;
        for (uint i = 1; i < level; ++i) first += width_of(i) * height_of(i);
        const uint rgba = (level == 0 ? picture : levels)[first + y * width_of(level) + x];
        return vec4(rgba & 255u, (rgba >> 8u) & 255u, (rgba >> 16u) & 255u, rgba >> 24u) / 255.0f;
    }
    // Between the centers of texels, in double; at the edges the last texel stays.
    glm::dvec4 linear(uint level, double u, double v) const {
        const double x = u * width_of(level) - 0.5, y = v * height_of(level) - 0.5;
        const auto at = [&](int dx, int dy) {
            const int column = std::clamp(int(std::floor(x)) + dx, 0, int(width_of(level)) - 1);
            const int row = std::clamp(int(std::floor(y)) + dy, 0, int(height_of(level)) - 1);
            return glm::dvec4(texel(level, uint(column), uint(row)));
        };
        const double s = x - std::floor(x), t = y - std::floor(y);
        return (1 - t) * ((1 - s) * at(0, 0) + s * at(1, 0)) + t * ((1 - s) * at(0, 1) + s * at(1, 1));
    }
    // An area of 4^level texels of the picture.
    glm::dvec4 seen(double level, double u, double v) const {
        const auto area = static_cast<float>(std::pow(4.0, level) / (16 * 8));
        return glm::dvec4(lookup_wide(Scene{}, map, vec2(u, v), area));
    }
    static double difference(const glm::dvec4& a, const glm::dvec4& b) {
        double largest = 0.0;
        for (int k = 0; k < 4; ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
        return largest;
    }

    std::vector<uint> picture, levels;
    Texture map{.width = 16,
                .height = 8,
                .format = TexelRgba8,
                .wrap_s = WrapClamp,
                .wrap_t = WrapClamp,
                .texture_filter = TextureLinear,
                .level_count = 4,
                .depth = 1};
};

// At the center of every texel of every level, with an area as large as that texel. Rounding of the level
// (a few 1e-7) and of the position (16 x 2^-24 of a texel) are the only differences.
TEST_F(Footprints, OfOneTexelGiveThatTexel) {
    for (uint level = 0; level <= 4; ++level) {
        for (uint y = 0; y < height_of(level); ++y) {
            for (uint x = 0; x < width_of(level); ++x) {
                const glm::dvec4 found =
                    seen(level, (x + 0.5) / width_of(level), (y + 0.5) / height_of(level));
                EXPECT_LE(difference(found, glm::dvec4(texel(level, x, y))), 4e-6)
                    << "level " << level << ", texel " << x << ' ' << y;
            }
        }
    }
}

TEST_F(Footprints, BetweenTwoMipLevelsAreInterpolated) {
    CounterRandom random(12);
    for (int i = 0; i < 1000; ++i) {
        const double level = 4.0 * random.uniform(), u = random.uniform(), v = random.uniform();
        const auto finer = static_cast<uint>(level);
        const double fraction = level - finer;
        const glm::dvec4 expected = (1 - fraction) * linear(finer, u, v) + fraction * linear(finer + 1, u, v);
        EXPECT_LE(difference(seen(level, u, v), expected), 1e-5) << level << ' ' << u << ' ' << v;
    }
}

TEST_F(Footprints, AreClampedToTheFinestAndCoarsestMipLevel) {
    for (const double level : {-30.0, -1.0, 0.0})
        EXPECT_LE(difference(seen(level, 0.3, 0.6), linear(0, 0.3, 0.6)), 1e-5) << level;
    for (const double level : {4.0, 7.5, 60.0})
        EXPECT_LE(difference(seen(level, 0.3, 0.6), glm::dvec4(texel(4, 0, 0))), 1e-5) << level;
    const vec4 of_infinity =
        lookup_wide(Scene{}, map, vec2(0.3f, 0.6f), std::numeric_limits<float>::infinity());
    EXPECT_LE(difference(glm::dvec4(of_infinity), glm::dvec4(texel(4, 0, 0))), 1e-5);
    map.level_count = 0;
    EXPECT_LE(difference(seen(3.0, 0.3, 0.6), linear(0, 0.3, 0.6)), 1e-5) << "without levels";
}

}  // namespace
}  // namespace tessera::shading
