// Overlapping projectors on a wall must form one uniform picture.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/display/projected_wall.h"

namespace tessera::display {
namespace {

using test::Arrangement;
using test::ProjectedWall;

const std::vector<Arrangement>& arrangements() {
    static const std::vector<Arrangement> all{{.columns = 2, .rows = 1, .overlap = 0.1},
                                              {.columns = 2, .rows = 1, .overlap = 0.2, .gamma = 0.0},
                                              {.columns = 3, .rows = 2, .overlap = 0.15},
                                              {.columns = 3, .rows = 2, .overlap = 0.2, .keystone = 0.4}};
    return all;
}

// Where the outlines of two pictures cross on the outer border of both, weights change from one to the other within a
// few pixels around that point, which pixels cannot resolve. So the border of the whole picture, which is masked on real
// walls, is excluded: 12 pixels of 320.
constexpr double Border = 12.0;

TEST(Projection, FlatFieldIsUniformWithinOnePercent) {
    for (const Arrangement& arrangement : arrangements()) {
        ProjectedWall wall(arrangement);
        for (const double light : {1.0, 0.18}) {
            const auto field = [&](double, double) { return static_cast<float>(light); };
            const frame::Image floats = wall.projected<float>(field),
                               bytes = wall.projected<std::uint8_t>(field);
            const auto in_overlaps = test::uniformity(wall, floats, light, 1, 2, Border);
            const auto everywhere = test::uniformity(wall, floats, light, 1, 1, Border);
            const auto to_the_border = test::uniformity(wall, floats, light, 1, 1, 1.0);
            const auto in_bytes = test::uniformity(wall, bytes, light, 8, 1, 1.0);
            EXPECT_LE(in_overlaps.error, 0.01);
            EXPECT_LE(everywhere.error, 0.01);
            EXPECT_LE(in_bytes.error, 0.01);
            EXPECT_GT(in_overlaps.squares, 3000);
            EXPECT_GT(in_bytes.squares, 1500);
            EXPECT_LE(to_the_border.beyond_a_percent, to_the_border.squares / 5000);
        }
    }
}

// A grid of dots a few pixels wide. Returns the largest distance between drawn and seen positions.
template <class Value>
double misplaced(ProjectedWall& wall) {
    const double pitch = wall.pitch(), sigma = 2.5 * pitch, between = 24 * pitch;
    const auto dots = [&](double x, double y) {
        const double dx = x - between * std::round(x / between), dy = y - between * std::round(y / between);
        return static_cast<float>(0.05 + 0.9 * std::exp(-(dx * dx + dy * dy) / (2 * sigma * sigma)));
    };
    const frame::Image image = wall.projected<Value>(dots);
    double most = 0.0;
    int found = 0;
    const int radius = 10;
    for (int row = -40; row <= 40; ++row)
        for (int column = -40; column <= 40; ++column) {
            const glm::dvec2 dot(column * between, row * between);
            const glm::dvec2 at((dot.x / wall.size().x + 0.5) * image.width - 0.5,
                                (0.5 - dot.y / wall.size().y) * image.height - 0.5);
            const int x0 = int(std::lround(at.x)), y0 = int(std::lround(at.y));
            if (x0 < radius || y0 < radius || x0 + radius >= int(image.width) ||
                y0 + radius >= int(image.height))
                continue;
            double mass = 0.0;
            glm::dvec2 sum(0.0);
            bool is_covered = true;
            for (int y = y0 - radius; y <= y0 + radius; ++y)
                for (int x = x0 - radius; x <= x0 + radius; ++x) {
                    is_covered = is_covered && wall.coverage(wall.position(image, x, y), 1.0) >= 1;
                    if (glm::length(glm::dvec2(x, y) - at) > radius - 1.5) continue;
                    const double value = image.pixel(std::size_t(y) * image.width + std::size_t(x))[0] - 0.05;
                    mass += value;
                    sum += value * (glm::dvec2(x, y) - at);
                }
            if (!is_covered) continue;
            ++found;
            most = std::max(most, glm::length(sum / mass));
        }
    EXPECT_GT(found, 100);
    return most;
}

TEST(Projection, DotsAreAccurateToATenthOfAPixel) {
    for (const Arrangement& arrangement : arrangements()) {
        ProjectedWall wall(arrangement);
        const double in_floats = misplaced<float>(wall), in_bytes = misplaced<std::uint8_t>(wall);
        EXPECT_LE(in_floats, 0.1);
        EXPECT_LE(in_bytes, 0.1);
    }
}

// The black level of the devices, which without a lift is two or four times as high in overlaps.
TEST(Projection, BlackLevelIsUniform) {
    const double black = 0.004;
    ProjectedWall wall({.columns = 3, .rows = 2, .black = black});
    const auto at_black = [&](double, double) { return 0.0f; };
    const frame::Image image = wall.projected<float>(at_black);
    int uneven = 0;  // excludes pixels on the edge of a projector
    for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::uint32_t x = 0; x < image.width; ++x) {
            const glm::dvec2 position = wall.position(image, x, y);
            const int sure = wall.coverage(position, 2.0);
            if (sure == 0 || sure != wall.coverage(position, -2.0)) continue;
            uneven += std::abs(image.pixel(std::size_t{y} * image.width + x)[1] / (4 * black) - 1.0) > 0.01;
        }
    EXPECT_EQ(uneven, 0);
    const auto white = [&](double, double) { return 1.0f; };
    const frame::Image bright = wall.projected<float>(white);
    const double expected = bright.pixel(std::size_t{bright.height} / 2 * bright.width + bright.width / 6)[1];
    EXPECT_LE(test::uniformity(wall, bright, expected, 1, 1, Border).error, 0.01);
    EXPECT_GT(expected, 0.98);
}

}  // namespace
}  // namespace tessera::display
