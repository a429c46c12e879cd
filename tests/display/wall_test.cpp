#include <gtest/gtest.h>

#include "mediator/base/error.h"
#include "mediator/display/wall_grid.h"

namespace tessera::display {

namespace {

std::string refusal(const glm::dvec3& lower_left, const glm::dvec3& lower_right, const glm::dvec3& upper_left,
                    const std::optional<glm::dvec3>& upper_right = {}) {
    try {
        wall(lower_left, lower_right, upper_left, upper_right);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(Wall, RejectsNonRectangularCorners) {
    const glm::dvec3 a{0, 0, -1}, b{2, 0, -1}, c{0, 1, -1}, d{2, 1, -1};
    EXPECT_EQ(refusal(a, b, c), "");
    EXPECT_EQ(refusal(a, b, c, d), "");
    EXPECT_NE(refusal(a, b, c, glm::dvec3(-2, 1, -1)).find("cross"), std::string::npos);
    EXPECT_NE(refusal(a, b, d).find("cross"), std::string::npos);
    EXPECT_NE(refusal(a, b, d, c).find("cross"), std::string::npos);
    EXPECT_NE(refusal(a, b, c, glm::dvec3(2, 1.2, -1)).find("complete"), std::string::npos);
    EXPECT_NE(refusal(a, a, c).find("no area"), std::string::npos);
    EXPECT_NE(refusal(a, b, a).find("no area"), std::string::npos);
    EXPECT_NE(refusal(a, b, glm::dvec3(1, 0, -1)).find("no area"), std::string::npos);
    EXPECT_NE(refusal(a, b, glm::dvec3(0.3, 1, -1)).find("degrees"), std::string::npos);
}

TEST(Wall, CorrectsSmallMeasurementErrors) {
    const Wall straight = wall({0, 0, 0}, {2, 0, 0}, {0.005, 1, 0});
    EXPECT_NEAR(straight.upward.x, 0.0, 1e-15);
    EXPECT_NEAR(straight.upward.y, std::hypot(1.0, 0.005), 1e-15);
}

TEST(WallGrid, BezelsHideTheirPart) {
    const Wall screen = wall({0, 0, 0}, {3.1, 0, 0}, {0, 2.05, 0});
    const std::vector<Part> all = parts(
        screen,
        {.columns = 3, .rows = 2, .width = 100, .height = 100, .bezel_across = 0.05, .bezel_upward = 0.05});
    ASSERT_EQ(all.size(), 6u);
    for (std::size_t i = 0; i < all.size(); ++i) {
        const double column = double(i % 3), row = double(i / 3);
        EXPECT_NEAR(all[i].left * 3.1, column * 1.05, 1e-12);
        EXPECT_NEAR(all[i].right * 3.1, column * 1.05 + 1.0, 1e-12);
        EXPECT_NEAR(all[i].top * 2.05, 2.05 - row * 1.05, 1e-12);
        EXPECT_NEAR(all[i].bottom * 2.05, 1.05 - row * 1.05, 1e-12);
    }
}

TEST(WallGrid, PixelsOfOverlapsCoincide) {
    const Wall screen = wall({0, 0, 0}, {3.6, 0, 0}, {0, 1, 0});  // 2 x 2000 - 400 pixels of a millimetre
    const std::vector<Part> all =
        parts(screen, {.columns = 2, .rows = 1, .width = 2000, .height = 1000, .overlap_across = 400});
    EXPECT_NEAR(all[0].right * 3.6, 2.0, 1e-12);
    EXPECT_NEAR(all[1].left * 3.6, 1.6, 1e-12);
    EXPECT_EQ(all[1].right, 1.0);
    EXPECT_EQ(all[0].bottom, 0.0);
}

TEST(WallGrid, RejectsGridsWithoutVisiblePixels) {
    const Wall screen = wall({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    EXPECT_THROW(parts(screen, {.columns = 3, .bezel_across = 0.5}), Error);
    EXPECT_THROW(parts(screen, {.columns = 2, .width = 100, .overlap_across = 51}), Error);
    EXPECT_THROW(parts(screen, {.rows = 2, .bezel_upward = 0.1, .overlap_upward = 10}), Error);
}

}  // namespace

}  // namespace tessera::display
