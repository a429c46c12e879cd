// Sums over squares of pixels, against sums of every pixel.
#include "master/filter/box_sums.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace tessera::filter {
namespace {

double brute_force(const Planes& planes, std::uint32_t component, std::int64_t x, std::int64_t y,
                   std::int64_t radius) {
    double sum = 0.0;
    for (std::int64_t v = std::max<std::int64_t>(0, y - radius);
         v <= std::min<std::int64_t>(planes.height() - 1, y + radius); ++v) {
        for (std::int64_t u = std::max<std::int64_t>(0, x - radius);
             u <= std::min<std::int64_t>(planes.width() - 1, x + radius); ++u)
            sum += planes.row(component, static_cast<std::uint32_t>(v))[u];
    }
    return sum;
}

void expect_same(const Planes& planes, std::uint32_t radius) {
    constexpr std::array<std::uint32_t, 2> Components{2, 0};
    std::vector<float> memory(BoxSums::size(planes.width(), radius, 2));
    std::uint32_t rows = 0;
    for (std::uint32_t block = 0; block < BoxSums::block_count(planes.height(), radius); ++block) {
        const BoxSums sums(planes, Components, block, radius, memory.data());
        EXPECT_EQ(sums.first_row(), rows);
        rows += sums.row_count();
        for (std::uint32_t row = 0; row < sums.row_count(); ++row) {
            for (std::size_t i = 0; i < 2; ++i) {
                for (std::uint32_t x = 0; x < planes.width(); ++x) {
                    const double expected =
                        brute_force(planes, Components[i], x, sums.first_row() + row, radius);
                    ASSERT_NEAR(sums.row(i, row)[x], expected, 2e-6 * expected)
                        << "component " << Components[i] << " at " << x << ", " << sums.first_row() + row;
                }
            }
        }
    }
    EXPECT_EQ(rows, planes.height());
}

TEST(BoxSums, AreThoseOfEveryPixel) {
    std::mt19937 random(1);
    for (const auto& [width, height] : {std::pair{37u, 29u}, {3u, 2u}, {1u, 1u}, {11u, 44u}}) {
        Planes planes(width, height, 3);
        for (float& v : planes.values()) v = std::uniform_real_distribution<float>(0.0f, 1.0f)(random);
        for (const std::uint32_t radius : {0u, 1u, 5u, 7u, 15u}) expect_same(planes, radius);
    }
}

TEST(BoxSums, LargeValuesLeaveNoRoundingInSmallOnes) {
    Planes planes(40, 40, 3);
    std::ranges::fill(planes.values(), 1e-3f);
    for (std::uint32_t c = 0; c < 3; ++c) planes.row(c, 20)[20] = 1e30f;
    expect_same(planes, 5);
}

}  // namespace
}  // namespace tessera::filter
