// Pictures through a lens against the closed form of the circle of confusion.
#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

struct Spread {
    double mean_x = 0.0, square_x = 0.0, square_y = 0.0, weight = 0.0;
    std::uint64_t hits = 0;
};

// Of the light in the picture, by the middles of its pixels on the plane at distance 1.
Spread spread(const SceneAdapter& world, const view::View& view, std::uint64_t spp) {
    const PathTracer tracer(world.tables(), world.scene(), view);
    const double edge = view.camera.right - view.camera.left;
    Spread found;
    std::uint64_t rays = 0;
    for (std::uint64_t sample = 0; sample < spp; ++sample) {
        for (std::uint32_t y = 0; y < view.height; ++y) {
            for (std::uint32_t x = 0; x < view.width; ++x) {
                const double light = red(tracer.trace(x, y, sample, rays));
                if (!(light > 0.0)) continue;
                const double px = view.camera.left + edge * (x + 0.5) / view.width;
                const double py = view.camera.top - edge * (y + 0.5) / view.height;
                found.mean_x += light * px;
                found.square_x += light * px * px;
                found.square_y += light * py * py;
                found.weight += light;
                ++found.hits;
            }
        }
    }
    found.mean_x /= found.weight;
    found.square_x /= found.weight;
    found.square_y /= found.weight;
    return found;
}

// A lamp of half edge h at depth d is seen at P / d + s (1 / f - 1 / d), P anywhere on it and s on the lens:
// so the variance of its picture is h^2 / (3 d^2) + k R^2 (1 / f - 1 / d)^2, with k = 1/4 for a uniform
// aperture and 0.1717 for the Gaussian one (tests/numerics). The pixels' middles lack the variance within a
// pixel. In an orthographic view nothing is divided by d: h^2 / 3 + k R^2 (1 - d / f)^2.
void expect_spread(view::View view, double depth, double focus, scene::Aperture aperture, double k) {
    SCOPED_TRACE(depth);
    constexpr double LampEdge = 0.075, Radius = 0.2;  // half the lamp's edge, as it would be without the lens
    const bool parallel = view.camera.projection == scene::Projection::Orthographic;
    const double scale = parallel ? 1.0 : depth;
    Model model;
    model.floor(model.material(lamp(1.0f)), float(LampEdge * scale), float(-depth));
    const SceneAdapter& world = model.build();
    view.camera.lens_radius = Radius;
    view.camera.focus_distance = focus;
    view.camera.aperture = aperture;
    const double pixel = (view.camera.right - view.camera.left) / view.width;
    const Spread found = spread(world, view, 448);
    const double blur = Radius * (depth / focus - 1.0) / scale;
    const double expected = LampEdge * LampEdge / 3.0 + k * blur * blur - pixel * pixel / 12.0;
    // The kurtosis of both parts is at most 2, so the relative standard error of x^2 is at most 1 /
    // sqrt(hits).
    ASSERT_GT(found.hits, 111'000u) << "a standard error of 0.3 %";
    const double error = 5.0 / std::sqrt(double(found.hits));
    EXPECT_NEAR(found.square_x / expected, 1.0, error);
    EXPECT_NEAR(found.square_y / expected, 1.0, error);
    EXPECT_NEAR(found.mean_x, 0.0, 5.0 * std::sqrt(expected / double(found.hits)));
}

constexpr double UniformSpread = 0.25, GaussianSpread = 0.17174;

TEST(Lens, ALampOutOfFocusIsAsWideAsItsCircleOfConfusion) {
    const view::View view = small_view({0, 0, 0}, 2.0 * std::atan(0.25), 64);
    expect_spread(view, 4.0, 1.0, scene::Aperture::Uniform, UniformSpread);
    expect_spread(view, 1.0, 4.0, scene::Aperture::Uniform, UniformSpread);
    expect_spread(view, 4.0, 1.0, scene::Aperture::Gaussian, GaussianSpread);
    expect_spread(view, 2.0, 2.0, scene::Aperture::Uniform, UniformSpread);  // sharp
}

TEST(Lens, ParallelViewsBlurAlike) {
    view::View view = small_view({0, 0, 0}, 0.5, 64);
    view.camera = view::pose({.projection = scene::Projection::Orthographic, .orthographic_height = 0.6},
                             view.camera.world_from_camera, 1.0);
    expect_spread(view, 4.0, 2.0, scene::Aperture::Uniform, UniformSpread);
    expect_spread(view, 1.0, 4.0, scene::Aperture::Gaussian, GaussianSpread);
}

// The eye is where the graph says, and so is the depth: along the axis, from the plane of the eye.
TEST(Lens, DepthIsAlongTheAxisForEveryCamera) {
    Model model;
    model.floor(model.material(chalk(glm::vec3(0.5f))), 50.0f, -3.0f);
    const SceneAdapter& world = model.build();
    for (const auto projection : {scene::Projection::Perspective, scene::Projection::Orthographic}) {
        for (const double radius : {0.0, 0.5}) {
            view::View view = small_view({1, 2, 2}, 1.0, 8);
            view.camera = view::pose({.projection = projection, .lens_radius = radius, .focus_distance = 2.0},
                                     view.camera.world_from_camera, 1.0);
            const Mean depth =
                mean_of(world, view, 16, [](const PathSample& sample) { return double(sample.depth); });
            EXPECT_NEAR(depth.value, 5.0, 1e-5);
            EXPECT_LT(depth.standard_error, 1e-6);
        }
    }
}

}  // namespace
}  // namespace tessera::embree
