#include "mediator/picture/srgb_bytes.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "mediator/picture/color.h"

namespace tessera::picture {
namespace {

TEST(SrgbBytes, RoundsLikeTheFormula) {
    const SrgbBytes to_srgb;
    // Every float is too many: all with these leading bits, which hit every entry of the table many times.
    for (std::uint32_t bits = 0; bits <= std::bit_cast<std::uint32_t>(1.0f); bits += 1021) {
        const auto linear = std::bit_cast<float>(bits);
        const double exact = 255.0 * srgb_from_linear(double{linear});
        if (std::abs(exact - std::floor(exact) - 0.5) < 1e-4) continue;  // between two codes
        ASSERT_EQ(to_srgb(linear), static_cast<int>(std::lround(exact))) << linear;
    }
}

TEST(SrgbBytes, ThresholdsAreExact) {
    const SrgbBytes to_srgb;
    for (int code = 0; code < 255; ++code) {
        // The least float of the next code, by bisection over the bits.
        std::uint32_t below = 0, above = std::bit_cast<std::uint32_t>(1.0f);
        while (above - below > 1) {
            const std::uint32_t middle = below + (above - below) / 2;
            const double srgb = 255.0 * srgb_from_linear(double{std::bit_cast<float>(middle)});
            (srgb >= code + 0.5 ? above : below) = middle;
        }
        const auto spread = [&](std::uint32_t bits) { return int{to_srgb(std::bit_cast<float>(bits))}; };
        // The formula and its inverse agree to a few units in the last place.
        EXPECT_EQ(spread(below - 64), code);
        EXPECT_EQ(spread(above + 64), code + 1);
    }
}

TEST(SrgbBytes, InvalidValuesAreBlackAndValuesAboveOneAreWhite) {
    const SrgbBytes to_srgb;
    EXPECT_EQ(to_srgb(std::numeric_limits<float>::quiet_NaN()), 0);
    EXPECT_EQ(to_srgb(-1.0f), 0);
    EXPECT_EQ(to_srgb(-std::numeric_limits<float>::infinity()), 0);
    EXPECT_EQ(to_srgb(0.0f), 0);
    EXPECT_EQ(to_srgb(std::numeric_limits<float>::denorm_min()), 0);
    EXPECT_EQ(to_srgb(1.0f), 255);
    EXPECT_EQ(to_srgb(std::nextafter(1.0f, 0.0f)), 255);
    EXPECT_EQ(to_srgb(65504.0f), 255);
    EXPECT_EQ(to_srgb(std::numeric_limits<float>::infinity()), 255);
}

}  // namespace
}  // namespace tessera::picture
