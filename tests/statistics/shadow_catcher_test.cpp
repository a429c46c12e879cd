// LT28: surfaces that show nothing but the shadows on them.
#include <gtest/gtest.h>

#include "tests/statistics/panels.h"

namespace tessera::embree {
namespace {

const glm::vec3 SkyColor{0.1f, 0.2f, 0.3f};
const glm::vec4 Shown{0.8f, 0.4f, 0.2f, 0.5f};

scene::Material catcher(float mask) {
    scene::Material material = chalk(glm::vec3(0.9f));
    material.base_color.w = mask;
    material.shadow_catcher = true;
    return material;
}

scene::Background background(scene::VisibleBackground visible) {
    return {.color = SkyColor, .visible = visible, .visible_color = Shown};
}

// A catcher of 2 m under a sky, seen from above.
struct Ground : Model {
    explicit Ground(float mask, scene::VisibleBackground visible = scene::VisibleBackground::Color) {
        floor(material(catcher(mask)), 1.0f, 0.0f);
        sky(background(visible));
    }
};

view::View picture(view::Renderer renderer) {
    view::View view = small_view({0.0, 0.0, 3.0}, 1.0);
    view.renderer = renderer;
    return view;
}

TEST(ShadowCatcher, ShowsTheBackgroundWithoutOccluders) {
    for (const view::Renderer renderer : {view::Renderer::PathTracing, view::Renderer::Whitted}) {
        for (const float mask : {0.0f, 0.5f, 1.0f}) {
            Ground colored(mask), lit(mask, scene::VisibleBackground::Environment);
            for_samples(colored.build(), picture(renderer), 4, [](const PathSample& sample) {
                ASSERT_EQ(radiance_of(sample), glm::vec3(Shown) * Shown.w);
                ASSERT_EQ(sample.alpha, Shown.w);
                ASSERT_TRUE(std::isinf(sample.depth));
            });
            for_samples(lit.build(), picture(renderer), 4,
                        [](const PathSample& sample) { ASSERT_EQ(radiance_of(sample), SkyColor); });
        }
    }
}

// A black panel above the origin occludes its fraction of all directions, within the mask.
TEST(ShadowCatcher, IsDarkerWhereObjectsOccludeTheSky) {
    Panel panel{{{{-0.4f, -0.3f, 0.5f}, {-0.3f, 0.5f, 0.5f}, {0.5f, -0.2f, 0.5f}}}};
    const double hidden = irradiance_of(panel) / M_PI;
    ASSERT_GT(hidden, 0.1);
    for (const float mask : {0.0f, 0.3f, 1.0f}) {
        Ground ground(mask);
        ground.triangles(ground.material(chalk(glm::vec3(0.0f))), {panel.corners});
        const SceneAdapter& world = ground.build();
        view::View view = small_view({0.0, 0.0, 0.3}, 1e-3);
        const Mean light = mean_of(world, view, 256, red);
        const double plain = double(Shown.x) * double(Shown.w), fraction = double(mask) * hidden;
        EXPECT_NEAR(light.value, plain * (1.0 - fraction), 4.0 * light.standard_error + 1e-6);
        const Mean alpha = mean_of(world, view, 256, [](const PathSample& s) { return double(s.alpha); });
        EXPECT_NEAR(alpha.value, double(Shown.w) * (1.0 - fraction) + fraction,
                    4.0 * alpha.standard_error + 1e-6);
        EXPECT_EQ(light.standard_error > 1e-5, mask > 0.0f);
    }
}

TEST(ShadowCatcher, ReflectsTheColourOfOccluders) {
    Panel panel{{{{-0.4f, -0.3f, 0.5f}, {-0.3f, 0.5f, 0.5f}, {0.5f, -0.2f, 0.5f}}}, 4.0};
    Ground ground(1.0f);
    ground.triangles(ground.material(lamp(4.0f)), {panel.corners});
    const SceneAdapter& world = ground.build();
    const double hidden = irradiance_of(panel) / (M_PI * panel.radiance);
    const Mean light = mean_of(world, small_view({0.0, 0.0, 0.3}, 1e-3), 256, red);
    EXPECT_NEAR(light.value, double(Shown.x) * double(Shown.w) * (1.0 - hidden) + 4.0 * hidden,
                4.0 * light.standard_error);
}

TEST(ShadowCatcher, IsInvisibleInMirrors) {
    for (const view::Renderer renderer : {view::Renderer::PathTracing, view::Renderer::Whitted}) {
        Ground ground(1.0f);
        ground.floor(ground.material(mirror(glm::vec3(1.0f))), -1.0f, 1.0f);
        view::View view =
            small_view({0.0, 0.0, 0.5}, 0.5, 16, glm::rotate(glm::dmat4(1.0), M_PI, {1.0, 0.0, 0.0}));
        view.renderer = renderer;
        for_samples(ground.build(), view, 2,
                    [](const PathSample& sample) { ASSERT_EQ(radiance_of(sample), SkyColor); });
    }
}

// The underside of an object sees the ground in the background's colour; light of the sky from below is blocked.
TEST(ShadowCatcher, LightsObjectsLikeTheBackground) {
    for (const float mask : {0.0f, 1.0f}) {
        Model model;
        model.floor(model.material(catcher(mask)), 1000.0f, 0.0f);
        model.floor(model.material(chalk(glm::vec3(0.5f))), -1.0f, 1.0f);
        model.sky(background(scene::VisibleBackground::Color));
        view::View view =
            small_view({0.0, 0.0, 0.5}, 1e-3, 16, glm::rotate(glm::dmat4(1.0), M_PI, {1.0, 0.0, 0.0}));
        view.max_bounces = 0;
        const Mean light = mean_of(model.build(), view, 1024, red);
        const double below = mask > 0.0f ? double(Shown.x) : double(SkyColor.x);
        EXPECT_NEAR(light.value / (0.5 * below), 1.0, 4.0 * light.standard_error / (0.5 * below) + 1e-4);
    }
}

// With a transparent background only the shadow remains: no light, no object, and the occluded fraction of the sky
// as alpha.
TEST(ShadowCatcher, IsTransparentWithATransparentBackground) {
    Ground ground(1.0f, scene::VisibleBackground::Environment);
    view::View view = picture(view::Renderer::PathTracing);
    view.transparent_background = true;
    for_samples(ground.build(), view, 4, [](const PathSample& sample) {
        ASSERT_EQ(radiance_of(sample), glm::vec3(0.0f));
        ASSERT_EQ(sample.alpha, 0.0f);
        ASSERT_EQ(sample.object, 0u);
    });
}

// Half of E3, twice: the fraction of an even sky's light on a plane that a slab of an optical depth lets
// through.
double light_through_slab(double depth) {
    constexpr int Steps = 20000;
    double sum = 0.0;
    for (int i = 0; i < Steps; ++i) {
        const double cosine = (i + 0.5) / Steps;
        sum += 2.0 * cosine * std::exp(-depth / cosine) / Steps;
    }
    return sum;
}

// A layer of fog dims the background behind the catcher as it would dim a ground there, and casts its own
// shadow; what it absorbs counts as coverage.
TEST(ShadowCatcher, IsAttenuatedByFogInFront) {
    for (const view::Renderer renderer : {view::Renderer::PathTracing, view::Renderer::Whitted}) {
        for (const float depth : {0.0f, 0.3f, 1.0f}) {
            Model model;
            model.floor(model.material(catcher(1.0f)), 1e4f, 0.0f);
            model.set_medium({.absorption = glm::vec3(depth)});
            model.box(ObjectId{}, {-1e4f, -1e4f, 0.5f}, {1e4f, 1e4f, 1.5f});
            model.sky(background(scene::VisibleBackground::Color));
            const SceneAdapter& world = model.build();
            view::View view = small_view({0.0, 0.0, 3.0}, 1e-3);
            view.renderer = renderer;
            const double passed = std::exp(-double(depth)) * light_through_slab(double(depth));
            const Mean light = mean_of(world, view, 1024, red);
            EXPECT_NEAR(light.value, passed * double(Shown.x) * double(Shown.w),
                        4.5 * light.standard_error + 1e-5);
            EXPECT_LE(light.standard_error, 0.003 * light.value + 1e-9);
            const Mean alpha =
                mean_of(world, view, 1024, [](const PathSample& s) { return double(s.alpha); });
            EXPECT_NEAR(alpha.value, 1.0 - (1.0 - double(Shown.w)) * passed,
                        4.5 * alpha.standard_error + 1e-5);
        }
    }
}

// Fog around the eye only, where it casts no shadow on visible points; fog below the ground is ignored.
TEST(ShadowCatcher, IsAttenuatedByFogAroundTheEyeOnly) {
    Model model;
    model.floor(model.material(catcher(1.0f)), 1e4f, 0.0f);
    model.set_medium({.absorption = glm::vec3(0.5f)});
    model.box(ObjectId{}, {-1e-3f, -1e-3f, 2.0f}, {1e-3f, 1e-3f, 4.0f});
    model.box(ObjectId{}, {-1e3f, -1e3f, -2.0f}, {1e3f, 1e3f, -1.0f});
    model.sky(background(scene::VisibleBackground::Color));
    const Mean light = mean_of(model.build(), small_view({0.0, 0.0, 3.0}, 1e-6), 256, red);
    EXPECT_NEAR(light.value, std::exp(-0.5) * double(Shown.x) * double(Shown.w), 1e-5);
}

// Purely scattering fog in uniform radiance: neither the fog nor the catcher is visible.
TEST(ShadowCatcher, IsInvisibleInAFogFurnace) {
    Model model;
    model.floor(model.material(catcher(1.0f)), 1e3f, 0.0f);
    model.set_medium({.scattering = glm::vec3(0.7f), .anisotropy = 0.3f});
    model.box(ObjectId{}, {-1, -1, 0.2f}, {1, 1, 1.2f});
    model.sky(glm::vec3(1.0f));
    const Mean light = mean_of(model.build(), small_view({0.0, 0.0, 3.0}, 0.5), 64, red);
    EXPECT_NEAR(light.value, 1.0, 4.5 * light.standard_error + 1e-4);
    EXPECT_LE(light.standard_error, 0.003);
}

// Lights without geometry do not occlude the sky, and neither they nor their shadows appear on the catcher.
TEST(ShadowCatcher, IgnoresLightsWithoutGeometry) {
    Ground ground(1.0f);
    ground.light({.kind = scene::LightKind::Sphere, .intensity = glm::vec3(3.0f), .radius = 0.5f},
                 glm::translate(glm::dmat4(1.0), {0.0, 0.0, 1.0}));
    for_samples(ground.build(), small_view({0.0, 0.0, 0.3}, 1e-3), 16,
                [](const PathSample& sample) { ASSERT_EQ(radiance_of(sample), glm::vec3(Shown) * Shown.w); });
}

// A plate that occludes the whole sky is lit by the ground below it, which emits like the background: the catcher
// receives that light reflected once, as indirect light.
TEST(ShadowCatcher, CatchesReflectedLightOfAPlate) {
    Model model;
    model.floor(model.material(catcher(1.0f)), 1000.0f, 0.0f);
    model.floor(model.material(chalk(glm::vec3(0.5f))), -1000.0f, 0.1f);
    model.sky(background(scene::VisibleBackground::Color));
    view::View view = small_view({0.0, 0.0, 0.05}, 1e-3);
    view.path_class = view::PathClass::Indirect;
    const SceneAdapter& world = model.build();
    const Mean light = mean_of(world, view, 256, red);
    EXPECT_NEAR(light.value, 0.5 * double(Shown.x), 4.5 * light.standard_error + 1e-3);
    const Mean indirect = mean_of(world, view, 256, [](const PathSample& s) { return double(s.high.x); });
    EXPECT_NEAR(indirect.value, light.value, 1e-6);
}

}  // namespace
}  // namespace tessera::embree
