// Extreme cases of overlapping projectors: keystone, very dark and overexposed pictures, and weights of 0.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/display/projected_wall.h"

namespace tessera::display {
namespace {

using test::ProjectedWall;

double error_of(ProjectedWall& wall, double light, double expected) {
    const auto field = [&](double, double) { return static_cast<float>(light); };
    const frame::Image image = wall.projected<float>(field);
    for (const float value : image.values)
        if (!std::isfinite(value)) return INFINITY;
    return test::uniformity(wall, image, expected, 1, 1, 12.0).error;
}

TEST(ProjectionNumerics, ExtremeKeystone) {
    ProjectedWall wall({.columns = 2, .rows = 2, .overlap = 0.2, .keystone = 1.5});
    EXPECT_LE(error_of(wall, 0.5, 0.5), 0.01);
}

TEST(ProjectionNumerics, VeryDarkPictures) {
    ProjectedWall wall({.columns = 3, .rows = 1, .overlap = 0.2});
    EXPECT_LE(error_of(wall, 1e-4, 1e-4), 0.012);  // half floats are 2^-10 apart, and smaller ones 2^-24
    EXPECT_LE(error_of(wall, 0x1p-14, 0x1p-14), 0.012);
}

TEST(ProjectionNumerics, OverexposedPicturesAreWhite) {
    ProjectedWall wall({.columns = 3, .rows = 1, .overlap = 0.2});
    EXPECT_LE(error_of(wall, 60000.0, 1.0), 0.01);
}

TEST(ProjectionNumerics, CoincidentProjectorsShareTheLight) {
    ProjectedWall wall(
        {.columns = 2, .rows = 1, .overlap = 1.0, .keystone = 0.0});  // two pictures, one above the other
    EXPECT_LE(error_of(wall, 0.7, 0.7), 0.001);
}

// The outermost pixels of a picture in the centre of another's: weights near 0, without a step.
TEST(ProjectionNumerics, WeightsVanishAtTheEdge) {
    ProjectedWall wall({.columns = 2, .rows = 1, .overlap = 0.2, .keystone = 0.0});
    tbb::task_arena arena(2);
    const auto maps = overlap(wall.projectors(), 0.0, arena);
    const std::size_t width = wall.projectors()[0].width, row = 120 * width;
    EXPECT_LT(maps[0].weights[row + width - 1], 1e-4f);
    EXPECT_GT(maps[0].weights[row + width - 1], 0.0f);
    EXPECT_LT(maps[1].weights[row], 1e-4f);
    for (std::size_t x = width - 64; x + 1 < width; ++x)
        EXPECT_LT(std::abs(maps[0].weights[row + x] - maps[0].weights[row + x + 1]), 0.05f);
    // Both cover the same point: their pixels coincide here.
    for (std::size_t x = 0; x < 64; ++x)
        EXPECT_NEAR(maps[0].weights[row + width - 64 + x] + maps[1].weights[row + x], 1.0, 1e-6) << x;
}

}  // namespace
}  // namespace tessera::display
