#include "mediator/display/frustum.h"

#include <gtest/gtest.h>

#include <glm/gtc/quaternion.hpp>
#include <random>

#include "mediator/base/error.h"
#include "mediator/display/wall_grid.h"
#include "tests/display/camera_math.h"

namespace tessera::display {

namespace {

using view::Eye;

// The wall of Schwenk's thesis: 6 x 4 projectors of 1440 x 1050, 8640 x 4200 pixels; here of 1.5 mm.
constexpr double Pitch = 0.0015, WallLeft = -6.48, WallBottom = 0.2, WallZ = -4.0;
const WallGrid ThesisGrid{.columns = 6, .rows = 4, .width = 1440, .height = 1050};

Wall thesis_wall() {
    return wall({WallLeft, WallBottom, WallZ}, {WallLeft + 8640 * Pitch, WallBottom, WallZ},
                {WallLeft, WallBottom + 4200 * Pitch, WallZ});
}

TEST(ThesisWall, EveryEyeAndOutputHasItsOwnFrustumInClosedForm) {
    const Wall whole = thesis_wall();
    const std::vector<Part> all = parts(whole, ThesisGrid);
    ASSERT_EQ(all.size(), 24u);
    const Head head{.position = {1.3, 1.7, 0.6}};
    for (const Eye eye : {Eye::Mono, Eye::Left, Eye::Right}) {
        const double side = eye == Eye::Left ? -0.032 : eye == Eye::Right ? 0.032 : 0.0;
        for (std::uint32_t i = 0; i < all.size(); ++i) {
            const std::uint32_t column = i % 6, row = i / 6;
            const view::CameraPose camera = frustum(projection_plane(whole, all[i]), head, eye, 0.064, 0.0);
            const double depth = head.position.z - WallZ;
            EXPECT_NEAR(camera.left, (WallLeft + column * 1440 * Pitch - 1.3 - side) / depth, 1e-12);
            EXPECT_NEAR(camera.right, (WallLeft + (column + 1) * 1440 * Pitch - 1.3 - side) / depth, 1e-12);
            EXPECT_NEAR(camera.top, (WallBottom + (4200 - row * 1050.0) * Pitch - 1.7) / depth, 1e-12);
            EXPECT_NEAR(camera.bottom, (WallBottom + (4200 - (row + 1) * 1050.0) * Pitch - 1.7) / depth,
                        1e-12);
            EXPECT_NEAR(camera.world_from_camera[3].x, 1.3 + side, 1e-15);
        }
    }
}

TEST(ThesisWall, NeighboursHaveBitIdenticalEdges) {
    const Wall whole = thesis_wall();
    const std::vector<Part> all = parts(whole, ThesisGrid);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> somewhere(-2.0, 2.0);
    for (int trial = 0; trial < 50; ++trial) {
        const Head head{.position = {somewhere(random), somewhere(random), somewhere(random)}};
        std::vector<view::CameraPose> cameras;
        for (const Part& part : all)
            cameras.push_back(
                frustum(projection_plane(whole, part), head, Eye::Right, 0.064, trial % 2 ? 3.0 : 0.0));
        for (std::size_t i = 0; i < all.size(); ++i) {
            EXPECT_EQ(cameras[i].world_from_camera, cameras[0].world_from_camera);
            EXPECT_TRUE(i % 6 == 5 || cameras[i].right == cameras[i + 1].left) << i;
            EXPECT_TRUE(i + 6 >= all.size() || cameras[i].bottom == cameras[i + 6].top) << i;
        }
    }
}

// Five sides of a cube around the origin, three metres wide: front, left, right, floor, ceiling.
struct Side {
    glm::dvec3 lower_left, lower_right, upper_left;
};
constexpr double Half = 1.5;
const std::array<Side, 5> Cave{{{{-Half, -Half, -Half}, {Half, -Half, -Half}, {-Half, Half, -Half}},
                                {{-Half, -Half, Half}, {-Half, -Half, -Half}, {-Half, Half, Half}},
                                {{Half, -Half, -Half}, {Half, -Half, Half}, {Half, Half, -Half}},
                                {{-Half, -Half, Half}, {Half, -Half, Half}, {-Half, -Half, -Half}},
                                {{-Half, Half, -Half}, {Half, Half, -Half}, {-Half, Half, Half}}}};

TEST(Cave, FromTheCentreEverySideIsNinetyDegrees) {
    for (const Side& side : Cave) {
        const ProjectionPlane plane =
            projection_plane(wall(side.lower_left, side.lower_right, side.upper_left));
        const view::CameraPose camera = frustum(plane, {}, Eye::Mono, 0.064, 0.0);
        EXPECT_NEAR(camera.left, -1.0, 1e-15);
        EXPECT_NEAR(camera.right, 1.0, 1e-15);
        EXPECT_NEAR(camera.bottom, -1.0, 1e-15);
        EXPECT_NEAR(camera.top, 1.0, 1e-15);
    }
}

TEST(Cave, OffCentreFrustaMatchTheSides) {
    const glm::dvec3 p{0.4, -0.3, 0.7};
    // Distance to the side, then how far its left, right, lower and upper edges are from the eye.
    struct Expected {
        double depth, left, right, bottom, top;
    };
    const std::array<Expected, 5> expected{
        {{Half + p.z, -Half - p.x, Half - p.x, -Half - p.y, Half - p.y},
         {Half + p.x, -Half + p.z, Half + p.z, -Half - p.y, Half - p.y},    // right is -z
         {Half - p.x, -Half - p.z, Half - p.z, -Half - p.y, Half - p.y},    // right is +z
         {Half + p.y, -Half - p.x, Half - p.x, -Half + p.z, Half + p.z},    // up is -z
         {Half - p.y, -Half - p.x, Half - p.x, -Half - p.z, Half - p.z}}};  // up is +z
    for (std::size_t i = 0; i < Cave.size(); ++i) {
        const Side& side = Cave[i];
        const ProjectionPlane plane =
            projection_plane(wall(side.lower_left, side.lower_right, side.upper_left));
        const view::CameraPose camera = frustum(plane, {.position = p}, Eye::Mono, 0.064, 0.0);
        EXPECT_NEAR(camera.left, expected[i].left / expected[i].depth, 1e-14) << i;
        EXPECT_NEAR(camera.right, expected[i].right / expected[i].depth, 1e-14) << i;
        EXPECT_NEAR(camera.bottom, expected[i].bottom / expected[i].depth, 1e-14) << i;
        EXPECT_NEAR(camera.top, expected[i].top / expected[i].depth, 1e-14) << i;
    }
}

TEST(Frustum, PointsOnTheWallDoNotMoveWithTheHead) {
    const Wall screen = wall({-1.2, 0.4, -2.0}, {1.1, 0.1, -2.6}, {-1.2 + 0.15, 0.4 + 1.15, -2.0});
    const ProjectionPlane plane = projection_plane(screen);
    const glm::dvec3 normal = glm::cross(plane.right, plane.up);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> part(0.0, 1.0), angle(-3.0, 3.0);
    for (int trial = 0; trial < 500; ++trial) {
        Head head;
        head.position = screen.corner + 5.0 * (part(random) - 0.5) * plane.right +
                        5.0 * (part(random) - 0.5) * plane.up + (0.1 + 4.0 * part(random)) * normal;
        head.orientation = glm::normalize(
            glm::dquat(angle(random), 0.1 * angle(random), angle(random), 0.1 * angle(random)));
        const double u = part(random), v = part(random);
        for (const Eye eye : {Eye::Mono, Eye::Left, Eye::Right}) {
            const glm::dvec2 place =
                image_position(frustum(plane, head, eye, 0.064, 0.0), point(screen, u, v));
            EXPECT_NEAR(place.x, u, 1e-11);
            EXPECT_NEAR(place.y, v, 1e-11);
        }
    }
}

TEST(Head, AnOrientationThatIsSentOnKeepsItsBits) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> component(-1.0, 1.0);
    for (int i = 0; i < 10000; ++i) {
        glm::dvec4 wxyz(component(random), component(random), component(random), component(random));
        wxyz *= (0.6 + 0.3 * i / 10000) / glm::length(wxyz);
        Head first, second;
        first.turn(wxyz);
        second.turn(first.wxyz());
        ASSERT_EQ(first, second) << i;
        ASSERT_NEAR(glm::length(first.wxyz()), 1.0, 1e-15);
    }
}

TEST(Frustum, PointsAtZeroParallaxCoincideForBothEyes) {
    const ProjectionPlane plane = projection_plane(wall({-1, -1, -2}, {1, -1, -2}, {-1, 1, -2}));
    const Head head{.position = {0.3, 0.2, 0.0}};
    for (const double distance : {0.7, 2.0, 9.0}) {
        const view::CameraPose left = frustum(plane, head, Eye::Left, 0.064, distance),
                               right = frustum(plane, head, Eye::Right, 0.064, distance),
                               middle = frustum(plane, head, Eye::Mono, 0.064, distance);
        const glm::dvec3 at = head.position + distance * glm::dvec3(0.1, -0.2, -1.0);
        const double parallax = image_position(right, at).x - image_position(left, at).x;
        EXPECT_NEAR(parallax, 0.0, 1e-13);
        const glm::dvec3 beyond = head.position + 2.0 * distance * glm::dvec3(0.1, -0.2, -1.0);
        EXPECT_GT(image_position(right, beyond).x, image_position(left, beyond).x);
        const glm::dvec3 before = head.position + 0.5 * distance * glm::dvec3(0.1, -0.2, -1.0);
        EXPECT_LT(image_position(right, before).x, image_position(left, before).x);
        const view::CameraPose screen = frustum(plane, head, Eye::Mono, 0.064, 0.0);
        EXPECT_NEAR(middle.left, screen.left, 1e-14);
        EXPECT_NEAR(middle.top, screen.top, 1e-14);
    }
}

TEST(Frustum, TheScreenMustBeInFrontOfTheEye) {
    const ProjectionPlane plane = projection_plane(wall({-1, -1, -2}, {1, -1, -2}, {-1, 1, -2}));
    EXPECT_THROW(frustum(plane, {.position = {0, 0, -2}}, Eye::Mono, 0.0, 0.0), Error);
    EXPECT_THROW(frustum(plane, {.position = {0, 0, -3}}, Eye::Mono, 0.0, 0.0), Error);
    EXPECT_THROW(frustum(plane, {.position = {0, 0, -3}}, Eye::Mono, 0.0, 1.0), Error);
    // The eyes are on both sides of the plane: one is behind it.
    Head sideways{.position = {0, 0, -1.99}};
    sideways.orientation = glm::angleAxis(1.5707963, glm::dvec3(0, 1, 0));
    EXPECT_THROW(
        {
            frustum(plane, sideways, Eye::Left, 0.064, 0.0);
            frustum(plane, sideways, Eye::Right, 0.064, 0.0);
        },
        Error);
}

}  // namespace

}  // namespace tessera::display
