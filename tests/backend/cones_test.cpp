// Widths of ray cones at surfaces.
#include <gtest/gtest.h>

#include <cmath>

#include "mediator/shading/ray_cones.h"

namespace tessera::shading {
namespace {

View view_of(uint camera) {
    View view{};
    view.forward = {0.0f, 0.0f, -1.0f};
    view.step = {0.02f, -0.005f};
    view.camera = camera;
    return view;
}

// On a plane in front of the eye, at any angle, a cone covers the area of a pixel.
TEST(Cones, OfACameraCoverAPixel) {
    for (const uint camera : {CameraPinhole, CameraLens, CameraOrthographic}) {
        const View view = view_of(camera);
        for (const float sine : {0.0f, 0.5f, 0.8f}) {
            const bool parallel = camera == CameraOrthographic;
            const float cosine = parallel ? 1.0f : std::sqrt(1.0f - sine * sine);
            const Ray ray{{0.0f, 0.0f, 0.0f}, {parallel ? 0.0f : sine, 0.0f, -cosine}};
            const float distance = 3.0f / cosine, scale = parallel ? 1.0f : 9.0f;
            for (const uint sample : {0u, 3u, 99u}) {
                const RayCone cone = camera_cone(view, ray, sample);
                const float width = cone.width + distance * cone.spread;
                const float pixel = scale * 0.02f * 0.005f / float(sample + 1);
                EXPECT_NEAR(width * width / cosine / pixel, 1.0f, 1e-5f) << camera << ' ' << sine;
            }
        }
    }
}

TEST(Cones, SpreadOfASampledDirectionFollowsItsPdf) {
    EXPECT_NEAR(chosen_spread(100.0f, 0), 0.1f, 1e-6f);
    EXPECT_NEAR(chosen_spread(100.0f, 3), 0.05f, 1e-6f);
    EXPECT_EQ(chosen_spread(0.1f, 0), 1.0f) << "no more than a radian";
}

// A triangle of half a square metre, three times as large in the world.
TEST(Cones, FootprintsAreRelativeToTwiceTheTriangleArea) {
    Scene scene{};
    scene.features = FeatureTextures;
    Instance instance{};
    instance.linear = mat3(3.0f);
    const Triangle triangle{{0.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}};
    EXPECT_NEAR(triangle_footprint(scene, instance, triangle, 1.0f, 1.5f), 0.25f, 1e-6f);
    EXPECT_NEAR(triangle_footprint(scene, instance, triangle, 0.5f, 1.5f), 0.5f, 1e-6f);
    EXPECT_EQ(triangle_footprint(scene, instance, triangle, 1.0f, 0.0f), 0.0f);
    scene.features = 0;
    EXPECT_EQ(triangle_footprint(scene, instance, triangle, 1.0f, 1.5f), 0.0f);
}

}  // namespace
}  // namespace tessera::shading
