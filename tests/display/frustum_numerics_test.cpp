#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mediator/display/frustum.h"
#include "mediator/display/wall_grid.h"
#include "tests/display/camera_math.h"

namespace tessera::display {

namespace {

constexpr double Epsilon = std::numeric_limits<double>::epsilon();

TEST(FrustumNumerics, TheSizeOfTheWallDoesNotMatter) {
    for (const double metres : {1e-3, 1.0, 1e3}) {
        const Wall screen = wall({-metres, -metres, -2 * metres}, {metres, -metres, -2 * metres},
                                 {-metres, metres, -2 * metres});
        const Head head{.position = {0.3 * metres, 0.1 * metres, 0.25 * metres}};
        for (const Part& part : parts(screen, {.columns = 5, .rows = 3})) {
            const view::CameraPose camera =
                frustum(projection_plane(screen, part), head, view::Eye::Mono, 0.0, 0.0);
            EXPECT_NEAR(camera.left, (2.0 * part.left - 1.3) / 2.25, 8 * Epsilon);
            EXPECT_NEAR(camera.top, (2.0 * part.top - 1.1) / 2.25, 8 * Epsilon);
        }
    }
}

TEST(FrustumNumerics, AHeadFarOffTheAxisSeesTheWallWhereItIs) {
    const Wall screen = wall({-1, -1, -2}, {1, -1, -2}, {-1, 1, -2});
    const ProjectionPlane plane = projection_plane(screen);
    for (const double far : {1e2, 1e4, 1e6}) {
        const Head head{.position = {far, -far, 1.0}};
        const view::CameraPose camera = frustum(plane, head, view::Eye::Mono, 0.0, 0.0);
        // Edges of size far that differ by 2/3: each is off by a few of its last bits.
        const double bound = 16.0 * Epsilon * far;
        for (const double u : {0.0, 0.25, 1.0}) {
            const glm::dvec2 place = image_position(camera, point(screen, u, 1.0 - u));
            EXPECT_NEAR(place.x, u, bound);
            EXPECT_NEAR(place.y, 1.0 - u, bound);
        }
    }
}

TEST(FrustumNumerics, AMicrometreInFrontOfTheWallIsStillInFront) {
    const Wall screen = wall({-1, -1, -2}, {1, -1, -2}, {-1, 1, -2});
    const Head head{.position = {0.2, 0.1, -2.0 + 1e-6}};
    const view::CameraPose camera = frustum(projection_plane(screen), head, view::Eye::Mono, 0.064, 0.0);
    const double depth = head.position.z + 2.0;
    EXPECT_NEAR(camera.left * depth, -1.2, 1e-12);
    EXPECT_NEAR(camera.right * depth, 0.8, 1e-12);
    const glm::dvec2 place = image_position(camera, point(screen, 0.3, 0.6));
    EXPECT_NEAR(place.x, 0.3, 1e-12);
    EXPECT_NEAR(place.y, 0.6, 1e-12);
}

TEST(FrustumNumerics, AWallFarFromTheOriginLosesNoMoreThanItsPlaceDoes) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> part(0.0, 1.0);
    for (const double far : {1e3, 1e6}) {
        const glm::dvec3 there(far, far, -far);
        const Wall screen = wall(there + glm::dvec3(-1, -1, -2), there + glm::dvec3(1, -1, -2),
                                 there + glm::dvec3(-1, 1, -2));
        const view::CameraPose camera =
            frustum(projection_plane(screen), {.position = there}, view::Eye::Mono, 0.064, 0.0);
        for (int trial = 0; trial < 100; ++trial) {
            const double u = part(random), v = part(random);
            const glm::dvec2 place = image_position(camera, point(screen, u, v));
            EXPECT_NEAR(place.x, u, 32 * Epsilon * far);
            EXPECT_NEAR(place.y, v, 32 * Epsilon * far);
        }
    }
}

}  // namespace

}  // namespace tessera::display
