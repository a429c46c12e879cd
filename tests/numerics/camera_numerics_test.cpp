// Rays of lenses and orthographic views against geometry in double, at the limits of float precision: distant
// cameras, near focus.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "mediator/backend/tables/view_record.h"
#include "mediator/base/random.h"
#include "mediator/shading/camera.h"
#include "mediator/shading/sampler.h"

namespace tessera::shading {
namespace {

constexpr double Ulp = 0x1p-24;

view::View lens_view(double radius, double focus, scene::Aperture aperture = scene::Aperture::Uniform) {
    view::View view;
    view.width = view.height = 64;
    view.camera = {.world_from_camera = glm::rotate(glm::dmat4(1.0), 0.7, {1.0, 2.0, 3.0}),
                   .left = -0.5,
                   .right = 0.7,
                   .bottom = -0.4,
                   .top = 0.6,
                   .lens_radius = radius,
                   .focus_distance = focus,
                   .aperture = aperture};
    return view;
}

// Where a ray crosses the plane at a depth, across and up, in the camera's axes.
glm::dvec2 at_depth(const view::View& view, const Ray& ray, double depth) {
    const glm::dmat3 axes(view.camera.world_from_camera);
    const glm::dvec3 start = glm::transpose(axes) * glm::dvec3(ray.origin);
    const glm::dvec3 along = glm::transpose(axes) * glm::dvec3(ray.direction);
    return glm::dvec2(start) + glm::dvec2(along) * ((depth + start.z) / -along.z);
}

TEST(LensNumerics, RaysOfAPointMeetInTheFocalPlane) {
    CounterRandom random(5);
    for (const auto projection : {scene::Projection::Perspective, scene::Projection::Orthographic}) {
        for (const double focus : {1e-3, 0.5, 3.0, 1e4}) {
            for (const double ratio : {0.01, 0.3, 2.0}) {
                view::View sharp = lens_view(0.0, focus), blurred = lens_view(ratio * focus, focus);
                sharp.camera.projection = blurred.camera.projection = projection;
                const View pinhole = backend::make_view(sharp, {}), lens = backend::make_view(blurred, {});
                for (int i = 0; i < 200; ++i) {
                    const uint x = random.below(64), y = random.below(64);
                    const vec2 u(random.uniform(), random.uniform());
                    const glm::dvec2 expected =
                        at_depth(sharp, camera_ray(pinhole, x, y, u, vec2(0.5f)), focus);
                    const Ray ray = camera_ray(lens, x, y, u, vec2(random.uniform(), random.uniform()));
                    // Each coordinate is a sum of the position, the lens offset and the direction's
                    // roundings, all times at most the focus distance and the larger of 1 and the ratio.
                    const double size = focus * std::max(1.0, ratio) + 1.0;
                    EXPECT_LT(glm::distance(at_depth(blurred, ray, focus), expected), 12.0 * Ulp * size)
                        << focus << " " << ratio;
                }
            }
        }
    }
}

// A point at depth d is spread over a disk of radius R |1 - d / f|, in proportion to the aperture. E[x^2]
// over the unit disk: 1/4 if uniform; for the Gaussian, whose integral is (1 - exp(-2 r^2)) / a with a = 1 -
// exp(-2): E[r^2] / 2 = (1 + (1 - a) ln(1 - a) / a) / 4.
TEST(LensNumerics, TheCircleOfConfusionHasTheRightRadiusAndVariance) {
    constexpr uint Count = 1u << 18;
    const double a = 1.0 - std::exp(-2.0);
    const double gaussian = (1.0 + (1.0 - a) * std::log(1.0 - a) / a) / 4.0;
    for (const auto& [aperture, spread] :
         {std::pair{scene::Aperture::Uniform, 0.25}, std::pair{scene::Aperture::Gaussian, gaussian}}) {
        const view::View view = lens_view(0.2, 2.0, aperture);
        const View record = backend::make_view(view, {});
        for (const double depth : {0.5, 1.0, 8.0}) {
            const double radius = 0.2 * std::fabs(1.0 - depth / 2.0);
            const glm::dvec2 center = at_depth(view, camera_ray(record, 20, 40, vec2(0.5f)), depth);
            double most = 0.0, squares_x = 0.0, squares_y = 0.0, product = 0.0;
            for (uint i = 0; i < Count; ++i) {
                const vec2 lens = sample_pair(make_sampler(20, 40, 3, i), 7u);
                const glm::dvec2 from =
                    at_depth(view, camera_ray(record, 20, 40, vec2(0.5f), lens), depth) - center;
                most = std::max(most, glm::length(from));
                squares_x += from.x * from.x / Count;
                squares_y += from.y * from.y / Count;
                product += from.x * from.y / Count;
            }
            EXPECT_LE(most, radius * (1.0 + 1e-5));
            EXPECT_GE(most, radius * 0.99) << "the rim is part of the lens";
            // Independent points would have a standard error of 1 / sqrt(Count) = 0.2 %, stratified ones
            // less.
            const double expected = radius * radius * spread;
            EXPECT_NEAR(squares_x / expected, 1.0, 0.01) << depth;
            EXPECT_NEAR(squares_y / expected, 1.0, 0.01) << depth;
            EXPECT_NEAR(product / expected, 0.0, 0.01) << depth;
        }
    }
}

TEST(ParallelNumerics, RaysAreParallelAtAnyDistance) {
    const double metres = 20.0;
    for (const double far : {0.0, 1e6, 1e12}) {
        view::View view = lens_view(0.0, 1.0);
        const glm::dvec3 eye(far, -far, 0.5 * far);
        view.camera.world_from_camera = glm::translate(glm::dmat4(1.0), eye) * view.camera.world_from_camera;
        view.camera.projection = scene::Projection::Orthographic;
        view.camera.left = view.camera.bottom = -0.5 * metres;
        view.camera.right = view.camera.top = 0.5 * metres;
        const View record = backend::make_view(view, eye);
        const vec3 direction = camera_ray(record, 0, 0, vec2(0.1f), vec2(0.5f)).direction;
        EXPECT_LT(glm::distance(glm::dvec3(direction), -glm::dvec3(view.camera.world_from_camera[2])),
                  2.0 * Ulp);
        for (const uint x : {0u, 1u, 31u, 63u}) {
            const Ray ray = camera_ray(record, x, 63u - x, vec2(0.5f), vec2(0.9f));
            EXPECT_EQ(ray.direction, direction) << "to the bit";
            const double across = (x + 0.5) / 64.0 * metres - 0.5 * metres;
            const glm::dvec3 expected = across * (glm::dvec3(view.camera.world_from_camera[0]) +
                                                  glm::dvec3(view.camera.world_from_camera[1]));
            EXPECT_LT(glm::distance(glm::dvec3(ray.origin), expected), 4.0 * Ulp * metres) << x;
        }
    }
}

TEST(PinholeNumerics, LensParametersHaveNoEffectWithoutALens) {
    const View record = backend::make_view(lens_view(0.0, 1e-3, scene::Aperture::Gaussian), {});
    EXPECT_EQ(record.camera, CameraPinhole);
    for (const vec2 lens : {vec2(0.0f), vec2(0.3f, 0.9f)}) {
        const Ray one = camera_ray(record, 5, 50, vec2(0.2f, 0.7f));
        const Ray other = camera_ray(record, 5, 50, vec2(0.2f, 0.7f), lens);
        EXPECT_EQ(one.direction, other.direction);
        EXPECT_EQ(one.origin, other.origin);
    }
}

TEST(PinholeNumerics, OnlyPinholeCamerasAreRasterised) {
    view::View view = lens_view(0.0, 1.0);
    view.renderer = view::Renderer::Raster;
    EXPECT_EQ(backend::make_view(view, {}).renderer, RendererRaster);
    view.camera.lens_radius = 0.1;
    EXPECT_EQ(backend::make_view(view, {}).renderer, RendererWhitted);
    view.camera.lens_radius = 0.0;
    view.camera.projection = scene::Projection::Orthographic;
    EXPECT_EQ(backend::make_view(view, {}).renderer, RendererWhitted);
    view.camera.projection = scene::Projection::Perspective;
    view.camera.motion = {view.camera.world_from_camera};
    EXPECT_EQ(backend::make_view(view, {}).renderer, RendererWhitted);
}

}  // namespace
}  // namespace tessera::shading
