// Unlit surfaces (KHR_materials_unlit): shown as they are, but they neither light nor shade what is around them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mediator/shading/fresnel.h"
#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

constexpr float Chalk = 0.6f;
constexpr double Sunshine = 3.0;

scene::Material unlit(const glm::vec3& color) {
    return {.base_color = glm::vec4(color, 1.0f), .double_sided = true, .unlit = true};
}

// Down onto the floor, from below all that hangs above it.
view::View onto_the_floor(std::uint32_t max_bounces = 4) {
    view::View view = small_view({0.0, 0.0, 0.5}, 1e-3);
    view.max_bounces = max_bounces;
    return view;
}

void add_noon(Model& model) {
    model.light({.kind = scene::LightKind::Directional, .intensity = glm::vec3(static_cast<float>(Sunshine))},
                glm::dmat4(1.0));
}

double light_on_floor(Model& model, const view::View& view, std::uint64_t spp) {
    const Mean mean = mean_of(model.build(), view, spp, red);
    EXPECT_LE(mean.standard_error, 0.003 * mean.value);
    return mean.value;
}

// All directions from the floor meet the dome, which is four times as bright as the sky beyond it.
TEST(Unlit, DomesNeitherLightNorHideTheSky) {
    for (const auto renderer : {view::Renderer::PathTracing, view::Renderer::Whitted}) {
        Model model;
        model.floor(model.material(chalk(glm::vec3(Chalk))), 5.0f, 0.0f);
        model.sphere(model.material(unlit(glm::vec3(4.0f))), {}, 9.0);
        model.sky(glm::vec3(1.0f));
        view::View view = onto_the_floor();
        view.renderer = renderer;
        EXPECT_NEAR(light_on_floor(model, view, 64), double(Chalk), 0.01 * double(Chalk));
    }
}

TEST(Unlit, SheetsCastNoShadow) {
    Model sunny, lamplit;
    for (Model* model : {&sunny, &lamplit}) {
        model->floor(model->material(chalk(glm::vec3(Chalk))), 5.0f, 0.0f);
        model->floor(model->material(unlit(glm::vec3(0.5f))), 5.0f, 1.0f);
    }
    add_noon(sunny);
    EXPECT_NEAR(light_on_floor(sunny, onto_the_floor(0), 1), double(Chalk) * Sunshine / std::numbers::pi,
                1e-5);
    lamplit.light({.kind = scene::LightKind::Point, .intensity = glm::vec3(8.0f)},
                  glm::translate(glm::dmat4(1.0), {0.0, 0.0, 2.0}));
    EXPECT_NEAR(light_on_floor(lamplit, onto_the_floor(0), 1), double(Chalk) * 2.0 / std::numbers::pi, 1e-4);
}

// The connection to the sun is traced segment by segment where it meets panes.
TEST(Unlit, SheetsCastNoShadowAmongPanes) {
    Model model;
    model.floor(model.material(chalk(glm::vec3(Chalk))), 5.0f, 0.0f);
    scene::Material pane = glass(1.5f);
    pane.thickness = 0.0f;
    const ObjectId clear = model.material(pane), sheet = model.material(unlit(glm::vec3(0.5f)));
    model.floor(clear, 5.0f, 1.0f);
    model.floor(sheet, 5.0f, 1.5f);
    model.floor(clear, 5.0f, 2.0f);
    add_noon(model);
    const double passed = 1.0 - double(shading::fresnel_dielectric(1.0f, 1.5f));
    const double expected = double(Chalk) * Sunshine / std::numbers::pi * passed * passed;
    EXPECT_NEAR(light_on_floor(model, onto_the_floor(0), 1), expected, 1e-4 * expected);
}

TEST(Unlit, IsSeenByTheCameraAndInMirrors) {
    for (const bool in_mirror : {false, true}) {
        Model model;
        if (in_mirror) model.floor(model.material(mirror(glm::vec3(1.0f))), 5.0f, 0.0f);
        model.sphere(model.material(unlit(glm::vec3(4.0f))), {}, 9.0);
        model.sky(glm::vec3(1.0f));
        for_samples(model.build(), onto_the_floor(), 2,
                    [&](const PathSample& sample) { EXPECT_NEAR(red(sample), 4.0, 1e-5); });
    }
}

// A diffuse bounce, and then a mirror: the ray is no longer the camera's.
TEST(Unlit, IsNoCausticOfMirrors) {
    Model model;
    model.floor(model.material(chalk(glm::vec3(Chalk))), 5.0f, 0.0f);
    model.floor(model.material(mirror(glm::vec3(1.0f))), -5.0f, 1.0f);
    model.sphere(model.material(unlit(glm::vec3(4.0f))), {}, 9.0);
    const Mean mean = mean_of(model.build(), onto_the_floor(), 16, red);
    EXPECT_EQ(mean.value, 0.0);
}

// Of fog without absorption only what it lets pass arrives.
TEST(Unlit, IsSeenThroughFogButLightsNoFog) {
    constexpr float Depth = 0.8f;
    Model model;
    model.floor(model.material(unlit(glm::vec3(1.0f))), 50.0f, 0.0f);
    model.set_medium({.scattering = glm::vec3(1.0f)});
    model.box({}, {-20.0f, -20.0f, 0.1f}, {20.0f, 20.0f, 0.1f + Depth});
    const Mean mean = mean_of(model.build(), small_view({0.0, 0.0, 2.0}, 1e-3), 512, red);
    EXPECT_NEAR(mean.value, std::exp(-Depth), 4.0 * mean.standard_error);
    EXPECT_LE(mean.standard_error, 0.01);
}

}  // namespace
}  // namespace tessera::embree
