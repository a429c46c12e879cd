// Boundaries of media: nesting and priorities, media that touch a surface, holes by alpha, transparent backgrounds.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/statistics/media_views.h"

namespace tessera::embree {
namespace {

using glm::vec3;

// ---- nested media ----

// Layers of four metres each along z, of absorption 0.1 and 0.2 where they overlap by two.
double through(std::int32_t first, std::int32_t second) {
    Model model;
    model.set_medium({.absorption = vec3(0.1f), .priority = first});
    model.box(NoMaterial, {-1, -1, 0}, {1, 1, 4});
    model.set_medium({.absorption = vec3(0.2f), .priority = second});
    model.box(NoMaterial, {-0.5f, -0.5f, 2}, {0.5f, 0.5f, 6});
    model.sky(vec3(1.0f));
    return -std::log(mean_of(model.build(), view_from_above(), 1, red).value);
}

TEST(NestedMedia, TheHigherPriorityFillsTheOverlap) {
    EXPECT_NEAR(through(1, 0), 4 * 0.1 + 2 * 0.2, 1e-5);
    EXPECT_NEAR(through(0, 1), 2 * 0.1 + 4 * 0.2, 1e-5);
    // At equal priority, the medium that was entered last: from above, the lower one.
    EXPECT_NEAR(through(0, 0), 4 * 0.1 + 2 * 0.2, 1e-5);
}

TEST(NestedMedia, TheEyeCanBeInSeveralMedia) {
    Model model;
    float size = 1.0f;
    double expected = 0.0;
    for (int i = 0; i < 6; ++i) {  // more than the stack holds: the innermost count most and are kept longest
        model.set_medium({.absorption = vec3(0.1f * float(i + 1)), .priority = 6 - i});
        model.box(NoMaterial, vec3(-size), vec3(size));
        expected += 0.1 * (i + 1) * (i < 4 ? (i == 0 ? 1.0 : 0.5 * double(size)) : 0.0);
        size *= 2.0f;
    }
    model.sky(vec3(1.0f));
    const SceneAdapter& world = model.build();
    const double depth = -std::log(mean_of(world, view_from_above(0.0), 1, red).value);
    EXPECT_NEAR(depth, expected, 1e-5);
}

// Clear glass keeps out the fog around it; a box of glass of index 1 does not refract.
TEST(NestedMedia, GlassExcludesSurroundingFog) {
    Model model;
    model.set_medium({.absorption = vec3(0.5f)});
    model.box(NoMaterial, {-2, -2, -2}, {2, 2, 2});
    model.clear_medium();
    model.box(model.material(glass(1.0f)), vec3(-1), vec3(1));
    model.sky(vec3(1.0f));
    const SceneAdapter& world = model.build();
    EXPECT_NEAR(-std::log(mean_of(world, view_from_above(), 1, red).value), 0.5 * 2.0, 1e-5);
    EXPECT_NEAR(-std::log(mean_of(world, view_from_above(0.0), 1, red).value), 0.5 * 1.0, 1e-5);
}

TEST(NestedMedia, HiddenObjectLayersHideTheirMedia) {
    Model model;
    model.set_medium({.absorption = vec3(0.5f)});
    model.box(NoMaterial, {-2, -2, -2}, {2, 2, 2});
    model.sky(vec3(1.0f));
    const SceneAdapter& world = model.build();
    view::View view = view_from_above(0.0);
    view.layers = 2;
    EXPECT_NEAR(mean_of(world, view, 1, red).value, 1.0, 1e-6);
}

// Fog that ends at the floor: where both are hit at once, the floor wins.
TEST(Media, FogCanShareAFaceWithTheFloor) {
    for (const double angle : {0.0, 0.6, 1.2}) {
        for (const float height : {0.0f, 0.37f, -123.456f}) {
            Model model;
            model.set_medium({.absorption = vec3(0.5f)});
            model.box(NoMaterial, {-30, -30, height}, {30, 30, height + 1.0f});
            model.clear_medium();
            model.floor(
                model.material(
                    {.base_color = {0, 0, 0, 1}, .emission = vec3(2.0f), .index_of_refraction = 1.0f}),
                100.0f, height);
            const SceneAdapter& world = model.build();
            const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), angle, glm::dvec3(1, 0, 0));
            const glm::dvec3 eye = glm::dvec3(turn * glm::dvec4(0, 0, 3, 1)) + glm::dvec3(0.01, 0.02, height);
            const Mean mean = mean_of(world, small_view(eye, 0.01, 16, turn), 16, red);
            const double expected = 2.0 * std::exp(-0.5 / std::cos(angle));
            EXPECT_NEAR(mean.value, expected, 0.03 * expected) << angle << " " << height;
            EXPECT_LE(mean.standard_error, 2e-3 * expected);
        }
    }
}

// Light reflected by the floor passes the fog again, as if the fog continued below.
TEST(Media, LightReflectedByTheFloorIsAttenuatedAgain) {
    const auto seen = [](float bottom) {
        Model model;
        model.set_medium({.absorption = vec3(0.5f)});
        model.box(NoMaterial, {-30, -30, bottom}, {30, 30, 1.0f});
        model.clear_medium();
        model.floor(model.material(chalk(vec3(0.8f))), 100.0f, 0.0f);
        model.sky(vec3(1.0f));
        return mean_of(model.build(), small_view({0.01, 0.02, 3}, 0.01), 64, red);
    };
    const Mean ends = seen(0.0f), goes_on = seen(-1.0f);
    EXPECT_NEAR(ends.value, goes_on.value, 4.5 * std::hypot(ends.standard_error, goes_on.standard_error));
    EXPECT_LE(goes_on.standard_error, 0.02 * goes_on.value);
    EXPECT_LE(goes_on.value, 0.8 * std::exp(-1.0));  // at least a metre of fog in both directions
}

// ---- holes in a boundary ----

// A black wall with a random half of it transparent, around fog.
void add_holed_fog(Model& model, float absorption, float alpha, scene::AlphaMode mode) {
    model.set_medium({.absorption = vec3(absorption)});
    model.box(model.material({.base_color = {0, 0, 0, alpha},
                              .alpha_mode = mode,
                              .double_sided = true,
                              .index_of_refraction = 1.0f}),
              {-50, -50, 0}, {50, 50, 2});
    model.clear_medium();
}

// Rays that enter through a hole are in the medium.
TEST(HoledMedia, AreEnteredThroughHoles) {
    for (const bool blends : {true, false}) {
        Model model;
        const float alpha = blends ? 0.5f : 0.0f;
        add_holed_fog(model, 0.4f, alpha, blends ? scene::AlphaMode::Blend : scene::AlphaMode::Mask);
        model.sky(vec3(3.0f));
        const SceneAdapter& world = model.build();
        EXPECT_TRUE(model.problems.empty());
        const double both_walls = double(1.0f - alpha) * double(1.0f - alpha);
        for (const view::View& view : {view_from_above(), whitted(view_from_above())}) {
            const Mean seen = mean_of(world, view, blends ? 4096 : 4, red);
            EXPECT_NEAR(seen.value, 3.0 * both_walls * std::exp(-0.8), 4.5 * seen.standard_error + 1e-5);
            EXPECT_LE(seen.standard_error, 0.003 * seen.value);
        }
        // From inside, one wall is left.
        const Mean within = mean_of(world, view_from_above(1.0), blends ? 4096 : 4, red);
        EXPECT_NEAR(within.value, 3.0 * double(1.0f - alpha) * std::exp(-0.4),
                    4.5 * within.standard_error + 1e-5);
    }
}

// So is light towards a floor below.
TEST(HoledMedia, AttenuateLightThroughHoles) {
    for (const scene::LightKind kind : {scene::LightKind::Directional, scene::LightKind::Point}) {
        Model model;
        add_holed_fog(model, 0.4f, 0.5f, scene::AlphaMode::Blend);
        model.floor(model.material(chalk(vec3(0.5f))), 10.0f, -2.0f);
        model.light({.kind = kind, .intensity = vec3(kind == scene::LightKind::Point ? 36.0f : 1.0f)},
                    glm::translate(glm::dmat4(1.0), glm::dvec3(0, 0, 4)));
        view::View view = view_from_above(-1.0);
        view.max_bounces = 0;
        const Mean seen = mean_of(model.build(), view, 4096, red);
        EXPECT_NEAR(seen.value, 0.5 / M_PI * 0.25 * std::exp(-0.8), 4.5 * seen.standard_error + 1e-6);
        EXPECT_LE(seen.standard_error, 0.003 * seen.value);
    }
}

// In front of nothing, the alpha of fog is one minus its transmittance.
TEST(Media, MediaCoverTransparentBackgrounds) {
    for (const float scattering : {0.0f, 0.5f}) {
        Model model;
        model.set_medium({.absorption = vec3(0.3f), .scattering = vec3(scattering)});
        model.box(NoMaterial, {-1, -1, 0}, {1, 1, 2});
        model.sky(vec3(1.0f));
        const SceneAdapter& world = model.build();
        view::View view = view_from_above();
        view.transparent_background = true;
        for (const view::View& looked : {view, whitted(view)}) {
            const Mean alpha =
                mean_of(world, looked, 256, [](const PathSample& s) { return double(s.alpha); });
            EXPECT_NEAR(alpha.value, -std::expm1(-2.0 * (0.3 + double(scattering))),
                        4.5 * alpha.standard_error + 1e-6);
        }
    }
}

// Behind a medium without a surface, the first hit is the object behind it.
TEST(Media, BoundariesWithoutASurfaceAreNotHits) {
    Model model;
    model.set_medium({.absorption = vec3(0.1f)});
    model.box(NoMaterial, {-1, -1, 0}, {1, 1, 2});
    model.clear_medium();
    model.floor(model.material(chalk(vec3(0.5f))), 3.0f, -1.0f);
    model.sky(vec3(1.0f));
    const SceneAdapter& world = model.build();
    for (const view::Renderer renderer :
         {view::Renderer::PathTracing, view::Renderer::Whitted, view::Renderer::Coverage}) {
        view::View view = view_from_above();
        view.renderer = renderer;
        for_samples(world, view, 1, [&](const PathSample& sample) {
            EXPECT_NEAR(double(sample.depth), 11.0, 1e-4);
            EXPECT_EQ(double(sample.alpha), 1.0);
        });
    }
}

}  // namespace
}  // namespace tessera::embree
