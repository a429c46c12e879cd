#include "mediator/display/warp_map.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "mediator/base/error.h"
#include "mediator/display/frustum.h"
#include "mediator/display/surface.h"
#include "tests/display/camera_math.h"

namespace tessera::display {

namespace {

constexpr double Degree = std::numbers::pi / 180.0;
constexpr std::uint32_t Width = 1920, Height = 1080;

glm::dvec3 interpolated(const WarpMap& grid, double u, double v) {
    const bool on_edges = grid.nodes == Grid::Nodes::Edges;
    const double x =
        std::clamp(on_edges ? u * (grid.columns - 1) : u * grid.columns - 0.5, 0.0, double(grid.columns - 1));
    const double y =
        std::clamp(on_edges ? v * (grid.rows - 1) : v * grid.rows - 0.5, 0.0, double(grid.rows - 1));
    const auto i = std::min(std::uint32_t(x), grid.columns - 2),
               j = std::min(std::uint32_t(y), grid.rows - 2);
    return glm::mix(glm::mix(grid.at(i, j), grid.at(i + 1, j), x - i),
                    glm::mix(grid.at(i, j + 1), grid.at(i + 1, j + 1), x - i), y - j);
}

// The ray through the view position of each device pixel hits the known point of the screen, for every eye, to a
// hundredth of a pixel.
void expect_every_pixel_hits(const Screen& screen, const Head& head) {
    const WarpMap grid = sample([&](double u, double v) { return point(screen, u, v); }, Width, Height);
    EXPECT_LT(grid.points.size(), std::size_t{Width} * Height / 10);
    const ProjectionPlane plane = projection_plane(grid, head.position);
    std::mt19937 random(11);
    std::uniform_int_distribution<std::uint32_t> column(0, Width - 1), row(0, Height - 1);
    for (const view::Eye eye : {view::Eye::Left, view::Eye::Right}) {
        const view::CameraPose camera = frustum(plane, head, eye, 0.064, 0.0);
        const glm::dvec3 from(camera.world_from_camera[3]);
        for (int trial = 0; trial < 2000; ++trial) {
            const double u = (column(random) + 0.5) / Width, v = (row(random) + 0.5) / Height;
            const glm::dvec3 known = point(screen, u, v);
            const glm::dvec2 place = image_position(camera, interpolated(grid, u, v));
            ASSERT_TRUE(place.x > 0.0 && place.x < 1.0 && place.y > 0.0 && place.y < 1.0)
                << place.x << " " << place.y;
            const double pixel = std::min(glm::distance(known, point(screen, u + 1.0 / Width, v)),
                                          glm::distance(known, point(screen, u, v + 1.0 / Height)));
            const glm::dvec3 off = glm::cross(direction_through(camera, place), known - from);
            ASSERT_LT(glm::length(off), 0.01 * pixel) << u << " " << v;
        }
    }
}

TEST(WarpMap, EveryPixelOfACylinderIsAccurate) {
    expect_every_pixel_hits(
        Cylinder{
            .centre = {0.1, 0.0, 0.2}, .radius = 3.0, .from = -0.8, .to = 0.7, .bottom = -1.0, .top = 1.2},
        {.position = {0.3, 0.1, 0.4}});
}

TEST(WarpMap, EveryPixelOfADomeIsAccurate) {
    expect_every_pixel_hits(Dome{.radius = 4.0,
                                 .from = -40 * Degree,
                                 .to = 35 * Degree,
                                 .bottom = 5 * Degree,
                                 .top = 65 * Degree,
                                 .tilt = 20 * Degree},
                            {.position = {0.2, -0.1, 0.1}});
}

TEST(WarpMap, ConvexScreenIsInsideItsView) {
    // A column, convex towards the viewer.
    const auto column = [](double u, double v) {
        const double angle = (u - 0.5) * 1.8;
        return glm::dvec3(0.5 * std::sin(angle), 1.0 - 2.0 * v, -3.0 + 0.5 * std::cos(angle));
    };
    const WarpMap grid = sample(column, 600, 1000);
    const view::CameraPose camera =
        frustum(projection_plane(grid, glm::dvec3(0)), {}, view::Eye::Mono, 0.064, 0.0);
    for (int i = 0; i < 600; ++i) {
        for (int j = 0; j < 1000; j += 7) {
            const glm::dvec2 place = image_position(camera, column((i + 0.5) / 600, (j + 0.5) / 1000));
            ASSERT_TRUE(place.x > 0.0 && place.x < 1.0 && place.y > 0.0 && place.y < 1.0);
        }
    }
}

TEST(WarpMap, FlatScreenHasMinimumNumberOfNodes) {
    const Wall screen{};
    const WarpMap grid = sample([&](double u, double v) { return point(screen, u, v); }, Width, Height);
    EXPECT_EQ(grid.columns, 5u);
    EXPECT_EQ(grid.rows, 5u);
}

TEST(WarpMap, RoughSurfaceHasANodePerPixel) {
    const auto rough = [](double u, double v) {
        return glm::dvec3(u + 0.002 * std::sin(900.0 * u), -v, -1.0 + 0.002 * std::cos(800.0 * v));
    };
    const WarpMap grid = sample(rough, 200, 100);
    EXPECT_EQ(grid.nodes, Grid::Nodes::Centres);
    EXPECT_EQ(grid.columns, 200u);
    EXPECT_EQ(grid.rows, 100u);
    EXPECT_EQ(grid.at(3, 5), rough(3.5 / 200, 5.5 / 100));
}

TEST(WarpMap, ProjectionPlaneFacesTheHeadForMirroredDevices) {
    const auto mirrored = [](double u, double v) { return glm::dvec3(1.0 - 2.0 * u, 0.5 - v, -2.0); };
    const ProjectionPlane plane = projection_plane(sample(mirrored, 320, 200), glm::dvec3(0));
    EXPECT_NEAR(glm::cross(plane.right, plane.up).z, 1.0, 1e-12);
    EXPECT_NEAR(plane.up.y, 1.0, 1e-12);
    const auto upside_down = [](double u, double v) { return glm::dvec3(1.0 - 2.0 * u, v - 0.5, -2.0); };
    EXPECT_NEAR(projection_plane(sample(upside_down, 320, 200), glm::dvec3(0)).up.y, 1.0, 1e-12);
}

TEST(WarpMap, ViewResolutionMatchesTheDevice) {
    const Wall screen{};
    const WarpMap grid = sample([&](double u, double v) { return point(screen, u, v); }, Width, Height);
    const ProjectionPlane plane = projection_plane(grid, glm::dvec3(0, 0, 0.3));
    // Its pixels are not square: the view has the same total number.
    const Size size = view_size(grid, plane, glm::dvec3(0, 0, 0.3), Width, Height);
    EXPECT_NEAR(double(size.width) * size.height, double(Width) * Height, 2.0 * (Width + Height));
    EXPECT_EQ(size.width, size.height);
}

TEST(WarpMap, NodesAtCentresAreExtrapolatedToTheEdges) {
    const WarpMap grid{.columns = 2,
                       .rows = 2,
                       .nodes = Grid::Nodes::Centres,
                       .points = {{-1, 1, -2}, {1, 1, -2}, {-1, -1, -2}, {1, -1, -2}}};
    const view::CameraPose camera =
        frustum(projection_plane(grid, glm::dvec3(0)), {}, view::Eye::Mono, 0.064, 0.0);
    EXPECT_NEAR(camera.left, -1.0, 1e-12);
    EXPECT_NEAR(camera.right, 1.0, 1e-12);
    EXPECT_NEAR(camera.top, 1.0, 1e-12);
}

TEST(WarpMap, VisiblePartOfAMaskedPictureIsInsideTheView) {
    // A circle, as projected by a fisheye lens.
    WarpMap grid{.columns = 300, .rows = 200, .nodes = Grid::Nodes::Centres, .points = {}};
    for (std::uint32_t row = 0; row < grid.rows; ++row) {
        for (std::uint32_t column = 0; column < grid.columns; ++column) {
            const double u = (column + 0.5) / grid.columns - 0.5, v = (row + 0.5) / grid.rows - 0.5;
            const bool is_lit = std::hypot(1.5 * u, v) < 0.47;
            grid.points.push_back(is_lit ? glm::dvec3(4 * u, -3 * v, -2.0 + u * u)
                                         : glm::dvec3(std::numeric_limits<double>::quiet_NaN()));
        }
    }
    const view::CameraPose camera =
        frustum(projection_plane(grid, glm::dvec3(0)), {}, view::Eye::Mono, 0.064, 0.0);
    for (const glm::dvec3& point : grid.points) {
        if (std::isnan(point.x)) continue;
        const glm::dvec2 place = image_position(camera, point);
        // The border may be off by a tenth of a pixel.
        ASSERT_TRUE(place.x > -3e-4 && place.x < 1 + 3e-4 && place.y > -5e-4 && place.y < 1 + 5e-4)
            << place.x << " " << place.y;
    }
}

TEST(WarpMap, RejectsScreensTooWideForOneFlatView) {
    const auto around = [](double u, double v) {
        const double angle = (u - 0.5) * 170.0 * Degree;
        return glm::dvec3(std::sin(angle), 0.5 - v, -std::cos(angle));
    };
    const WarpMap grid = sample(around, 1000, 500);
    try {
        projection_plane(grid, glm::dvec3(0));
        FAIL() << "a screen of 170 degrees was accepted";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("split"), std::string::npos) << error.what();
    }
    const auto line = [](double u, double) { return glm::dvec3(u, 0.0, -1.0); };
    EXPECT_THROW(projection_plane(sample(line, 100, 100), glm::dvec3(0)), Error);
}

}  // namespace

}  // namespace tessera::display
