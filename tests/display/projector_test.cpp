#include "mediator/display/projector.h"

#include <gtest/gtest.h>

#include <random>

#include "mediator/base/error.h"

namespace tessera::display {

namespace {

TEST(Projector, AlignedProjectorHasRectangularPicture) {
    // Throw ratio 2 from 4 m: 2 m wide, 1 m high, moved up by half its height.
    const Projector projector{.position = {0, 0, 0},
                              .look_at = {0, 0, -4},
                              .horizontal_fov = 2.0 * std::atan(0.25),
                              .shift = {0.0, 0.5}};
    const view::CameraPose camera = pose(projector, 2.0);
    const Screen screen = Wall{.corner = {-5, -5, -4}, .across = {10, 0, 0}, .upward = {0, 10, 0}};
    const auto at = [&](double u, double v) { return *hit(screen, glm::dvec3(0), ray(camera, u, v)); };
    EXPECT_NEAR(glm::distance(at(0, 0), glm::dvec3(-1, 1, -4)), 0.0, 1e-14);
    EXPECT_NEAR(glm::distance(at(1, 0), glm::dvec3(1, 1, -4)), 0.0, 1e-14);
    EXPECT_NEAR(glm::distance(at(0, 1), glm::dvec3(-1, 0, -4)), 0.0, 1e-14);
}

TEST(Projector, ProjectionInvertsIntersection) {
    const Projector projector{.position = {0.5, 1.8, 0.7},
                              .look_at = {-0.3, 0.1, -3.0},
                              .up = {0.1, 1.0, 0.0},
                              .shift = {0.1, -0.4}};
    const view::CameraPose camera = pose(projector, 16.0 / 9.0);
    const std::array<Screen, 3> screens{
        Wall{.corner = {-2, -1, -3}, .across = {4, 0, 0.4}, .upward = {0, 2, 0}},
        Cylinder{.centre = {0, 0, 0.3}, .radius = 3.5, .from = -1, .to = 1, .bottom = -2, .top = 2},
        Dome{.radius = 4.0, .from = -1, .to = 1, .bottom = -0.5, .top = 1.0, .tilt = 0.2}};
    std::mt19937 random(5);
    std::uniform_real_distribution<double> part(0.0, 1.0);
    for (const Screen& screen : screens) {
        for (int trial = 0; trial < 200; ++trial) {
            const glm::dvec2 place{part(random), part(random)};
            const auto on_screen = hit(screen, projector.position, ray(camera, place.x, place.y));
            ASSERT_TRUE(on_screen);
            const auto again = image_coordinates(camera, *on_screen);
            ASSERT_TRUE(again);
            EXPECT_NEAR(again->x, place.x, 1e-12);
            EXPECT_NEAR(again->y, place.y, 1e-12);
        }
    }
    const Cylinder cylinder = std::get<Cylinder>(screens[1]);
    const glm::dvec3 met = *hit(screens[1], projector.position, ray(camera, 0.2, 0.3));
    EXPECT_NEAR(std::hypot(met.x, met.z - 0.3), cylinder.radius, 1e-12);
    EXPECT_NEAR(glm::length(*hit(screens[2], projector.position, ray(camera, 0.2, 0.3))), 4.0, 1e-12);
}

TEST(Projector, ProjectorBehindCurvedScreenHitsNearSide) {
    const Screen screen = Cylinder{.radius = 2.0, .from = -0.5, .to = 0.5, .bottom = -1, .top = 1};
    const auto front = hit(screen, {0, 0, 1.5}, {0, 0, -1});
    const auto rear = hit(screen, {0, 0, -5}, {0, 0, 1});
    ASSERT_TRUE(front && rear);
    EXPECT_NEAR(front->z, -2.0, 1e-14);
    EXPECT_NEAR(rear->z, -2.0, 1e-14);
}

TEST(Projector, RaysAwayFromTheScreenDoNotHit) {
    EXPECT_FALSE(hit(Wall{}, {0, 0, 0}, {0, 0, 1}));
    EXPECT_FALSE(hit(Wall{}, {0, 0, 0}, {1, 0, 0}));
    EXPECT_FALSE(hit(Cylinder{}, {0, 0, 0}, {0, 1, 0}));
    EXPECT_FALSE(hit(Dome{}, {0, 0, 3}, {0, 0, 1}));
    EXPECT_FALSE(image_coordinates(pose({}, 1.0), {0, 0, 1}));
}

TEST(Projector, RejectsNullDirection) {
    EXPECT_THROW(pose({.look_at = {0, 0, 0}}, 1.0), Error);
    EXPECT_THROW(pose({.look_at = {0, 3, 0}}, 1.0), Error);
}

}  // namespace

}  // namespace tessera::display
