// Equiangular sampling of lights in fog: the sampling strategies agree with each other and with closed forms,
// down to lights on the ray.
#include "mediator/shading/equiangular.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mediator/base/random.h"
#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

using glm::vec3;
using shading::Span, shading::SpanView;

constexpr ObjectId FogAlone{};
constexpr double MostError = 0.003;  // standard error of each mean, as a share of it

Mean seen_with(const SceneAdapter& world, const view::View& view, Strategy strategy, std::uint64_t spp) {
    const PathTracer tracer(world.tables(), world.scene(), view, strategy);
    double sum = 0, squares = 0;
    std::uint64_t rays = 0;
    const std::uint32_t pixels = view.width * view.height;
    for (std::uint64_t i = 0; i < pixels * spp; ++i) {
        const auto pixel = static_cast<std::uint32_t>(i % pixels);
        const double value = red(tracer.trace(pixel % view.width, pixel / view.width, i / pixels, rays));
        sum += value;
        squares += value * value;
    }
    const double n = double(pixels) * double(spp), mean = sum / n;
    return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / n)};
}

void expect_agreement(Model& model, std::uint64_t spp, view::View view) {
    const SceneAdapter& world = model.build();
    EXPECT_TRUE(model.problems.empty());
    const Mean both = seen_with(world, view, Strategy::Both, 2 * spp);
    EXPECT_GT(both.value, 0.0);
    EXPECT_LE(both.standard_error, MostError * both.value);
    for (const Strategy strategy : {Strategy::FlightOnly, Strategy::EquiangularOnly}) {
        const Mean alone = seen_with(world, view, strategy, 4 * spp);
        EXPECT_NEAR(alone.value, both.value, 4.5 * std::hypot(alone.standard_error, both.standard_error))
            << static_cast<unsigned>(strategy);
        EXPECT_LE(alone.standard_error, MostError * alone.value) << static_cast<unsigned>(strategy);
    }
}

view::View of_the_middle(std::uint32_t bounces) {
    view::View view = small_view({0, 0, 5}, 0.5);
    view.max_bounces = bounces;
    return view;
}

void add_lamp_fog(Model& model) {
    model.set_medium({.absorption = vec3(0.1f), .scattering = vec3(0.4f, 0.7f, 0.2f), .anisotropy = 0.4f});
    model.box(FogAlone, {-2, -2, -2}, {2, 2, 2});
    model.clear_medium();
}

glm::dmat4 at(const glm::dvec3& place) {
    return glm::translate(glm::dmat4(1.0), place);
}
// Shines down along -y from above, and a little to the eye.
glm::dmat4 from_above(const glm::dvec3& place) {
    return at(place) * glm::rotate(glm::dmat4(1.0), -1.3, {1, 0, 0});
}

// Light comes from outside: close to a light, free flight sampling alone converges too slowly.
TEST(Equiangular, StrategiesAgreeForAPointLight) {
    for (const view::Renderer renderer : {view::Renderer::PathTracing, view::Renderer::Whitted}) {
        Model model;
        add_lamp_fog(model);
        model.floor(model.material(chalk(vec3(0.5f))), 1.5f, -1.0f);
        model.light({.kind = scene::LightKind::Point, .intensity = vec3(1.0f)}, at({0.8, 2.9, 0.4}));
        view::View view = of_the_middle(renderer == view::Renderer::Whitted ? 0 : 2);
        view.renderer = renderer;
        expect_agreement(model, 512, view);
    }
}

TEST(Equiangular, StrategiesAgreeForASpotLight) {
    Model model;
    add_lamp_fog(model);
    model.light({.kind = scene::LightKind::Spot,
                 .intensity = vec3(20.0f),
                 .inner_cone_angle = 0.3f,
                 .outer_cone_angle = 0.6f},
                from_above({0, 3, 0}));
    expect_agreement(model, 1024, of_the_middle(0));
}

// In nested media, the inner one denser and of another colour.
TEST(Equiangular, StrategiesAgreeInNestedFog) {
    Model model;
    add_lamp_fog(model);
    model.set_medium({.scattering = vec3(1.5f, 0.2f, 3.0f), .anisotropy = -0.3f, .priority = 1});
    model.sphere(FogAlone, {0.2, -0.1, 0}, 0.8);
    model.clear_medium();
    model.light({.kind = scene::LightKind::Point, .intensity = vec3(1.0f)}, at({0.7, 2.9, 0.2}));
    expect_agreement(model, 512, of_the_middle(1));
}

TEST(Equiangular, StrategiesAgreeInTexturedFog) {
    for (const scene::TextureFilter filter : {scene::TextureFilter::Linear, scene::TextureFilter::Nearest}) {
        CounterRandom random(9);
        Model model;
        std::vector<float> texels;
        for (int i = 0; i < 3 * 2 * 2 * 4; ++i) {
            const bool is_empty = i / 3 % 4 == 0;  // of all channels
            texels.push_back(is_empty ? 0.0f : static_cast<float>(random.uniform()));
        }
        const scene::TextureSlot texture = model.texture({.width = 2,
                                                          .height = 2,
                                                          .format = scene::TexelFormat::RgbFloat,
                                                          .wrap_s = scene::Wrap::Clamp,
                                                          .wrap_t = scene::Wrap::Clamp,
                                                          .filter = filter,
                                                          .depth = 4},
                                                         texels);
        model.set_medium(
            {.absorption = vec3(0.1f), .scattering = vec3(1.0f, 0.5f, 0.2f), .scattering_texture = texture});
        model.box(FogAlone, {-2, -2, -2}, {2, 2, 2});
        model.clear_medium();
        model.light({.kind = scene::LightKind::Point, .intensity = vec3(1.0f)}, at({0.7, 2.9, 0.2}));
        expect_agreement(model, 320, of_the_middle(0));
    }
}

// Area lights are also hit by BSDF and phase function samples.
TEST(Equiangular, StrategiesAgreeForAreaLights) {
    for (const int kind : {0, 1, 2}) {
        Model model;
        add_lamp_fog(model);
        if (kind == 0) {
            model.light({.kind = scene::LightKind::Sphere, .intensity = vec3(4.0f), .radius = 0.8f},
                        at({0.4, 2.2, 0}));
        } else if (kind == 1) {
            model.light({.kind = scene::LightKind::Quad, .intensity = vec3(4.0f), .size = {1.6f, 1.4f}},
                        from_above({0.3, 2.8, 0}));
        } else {
            model.triangles(model.material(lamp(5.0f)),
                            {{vec3(2.7f, -1.3f, -1), vec3(2.7f, 1.3f, -1), vec3(2.9f, 0, 1.5f)}});
        }
        expect_agreement(model, 512, of_the_middle(0));
    }
}

// Each segment selects other lights, some of which are not in the light tree.
TEST(Equiangular, StrategiesAgreeForManyLights) {
    Model model;
    add_lamp_fog(model);
    CounterRandom random(4);
    for (int i = 0; i < 40; ++i) {
        const auto number = [&] { return 1.8 * (2.0 * random.uniform() - 1.0); };
        const glm::dvec3 place(number(), 3.0 + number() / 3.0, number());
        // Some illuminate few of the segments, or none.
        const scene::LightKind kind = i % 2 == 0 ? scene::LightKind::Point : scene::LightKind::Spot;
        model.light({.kind = kind, .intensity = vec3(float(i % 4 + 1)), .outer_cone_angle = 0.5f},
                    i % 4 == 1 ? at(place) : from_above(place));
    }
    model.light({.kind = scene::LightKind::Directional, .intensity = vec3(3.0f)}, from_above({}));
    model.sky(vec3(0.3f));
    expect_agreement(model, 512, of_the_middle(0));
}

// Behind glass, with a light inside of it; around that the air is clear.
TEST(Equiangular, StrategiesAgreeForFogInGlass) {
    Model model;
    model.set_medium({.scattering = vec3(1.0f)});
    model.sphere(model.material(glass(1.0f)), {0, 0, 0}, 1.5);
    model.set_medium({.absorption = vec3(1e-3f), .priority = 1});
    model.sphere(FogAlone, {0.1, 0.6, 0.2}, 0.6);
    model.clear_medium();
    model.light({.kind = scene::LightKind::Point, .intensity = vec3(1.0f)}, at({0.1, 0.6, 0.2}));
    expect_agreement(model, 512, of_the_middle(1));
}

// ---- one ray past one light ----

// Fog of the optical depth `depth` between z = -2 and 2, seen from z = 5 along -z, and a light of intensity 1
// at the distance `height` of that ray, at z = `foot`: single scattering.
double scattered_once(double depth, double height, double foot) {
    constexpr int Steps = 200000;
    const double rate = depth / 4.0;
    const double end = std::min(4.0, 40.0 / rate);  // behind it is no light
    const double from = std::atan2(foot - 2.0, height), to = std::atan2(foot - 2.0 + end, height);
    double sum = 0.0;
    for (int i = 0; i < Steps; ++i) {
        // By the angle, in which the light's own falloff is even.
        const double along = height * std::tan(from + (to - from) * (i + 0.5) / Steps), z = foot - along;
        const double distance = std::hypot(height, along);
        double in_fog = distance;
        if (foot > 2.0) in_fog *= (2.0 - z) / (foot - z);
        if (foot < -2.0) in_fog *= (2.0 + z) / (z - foot);
        sum += std::exp(-rate * (2.0 - z + in_fog));
    }
    return sum / Steps * (to - from) / height * rate / (4.0 * M_PI);
}

struct Pass {
    float depth;
    double height, foot;
};

Mean seen_past(const Pass& pass, Strategy strategy, std::uint64_t spp, view::Renderer renderer) {
    Model model;
    model.set_medium({.scattering = vec3(pass.depth / 4.0f)});
    // With its front at 0, where points closer than a mean free path can be resolved in floats.
    model.box(FogAlone, {-1e3f, -1e3f, -4}, {1e3f, 1e3f, 0});
    model.clear_medium();
    model.light({.kind = scene::LightKind::Point, .intensity = vec3(1.0f)},
                at({pass.height, 0, pass.foot - 2.0}));
    view::View view = small_view({0, 0, 3}, 1e-12, 4);
    view.max_bounces = 0;
    view.renderer = renderer;
    return seen_with(model.build(), view, strategy, spp);
}

// Lights down to a millionth of a metre from the ray, in almost clear to almost opaque fog.
TEST(EquiangularNumerics, MatchesTheIntegralAlongTheRay) {
    for (const Pass& pass :
         {Pass{0.5f, 0.3, 0.0}, Pass{0.5f, 1e-3, 0.5}, Pass{0.5f, 1e-6, 0.0}, Pass{1e-6f, 0.3, 0.0},
          Pass{1e-6f, 1e-6, 0.0}, Pass{5.0f, 0.1, 1.5}, Pass{1e6f, 0.5, 2.5},
          // The foot of the light's height before the beginning and behind the end.
          Pass{0.5f, 0.2, 2.5}, Pass{0.5f, 0.2, -2.5}, Pass{0.5f, 1e-3, -3.0}}) {
        const double expected = scattered_once(pass.depth, pass.height, pass.foot);
        ASSERT_GT(expected, 0.0);
        for (const view::Renderer renderer : {view::Renderer::PathTracing, view::Renderer::Whitted}) {
            for (const Strategy strategy : {Strategy::Both, Strategy::EquiangularOnly}) {
                // Almost opaque fog has almost no sample points near its front.
                if (strategy != Strategy::Both && pass.depth > 100.0f) continue;
                const Mean seen = seen_past(pass, strategy, 4096, renderer);
                EXPECT_NEAR(seen.value, expected, 4.5 * seen.standard_error + 1e-4 * expected)
                    << pass.depth << " " << pass.height << " " << pass.foot << " "
                    << static_cast<unsigned>(strategy);
                EXPECT_LE(seen.standard_error, MostError * expected)
                    << pass.depth << " " << pass.height << " " << pass.foot << " "
                    << static_cast<unsigned>(strategy);
            }
        }
    }
}

TEST(EquiangularNumerics, FreeFlightSamplingGivesTheSame) {
    const Pass pass{0.5f, 0.3, 0.0};
    const double expected = scattered_once(pass.depth, pass.height, pass.foot);
    const Mean seen = seen_past(pass, Strategy::FlightOnly, 65536, view::Renderer::PathTracing);
    EXPECT_NEAR(seen.value, expected, 4.5 * seen.standard_error);
    EXPECT_LE(seen.standard_error, MostError * expected);
}

// On the ray itself the radiance diverges: samples stay finite and not negative.
TEST(EquiangularNumerics, ALightOnTheRayIsFinite) {
    for (const double foot : {0.0, 1.0, 2.0, -2.0, 3.0, 5.0}) {
        for (const Strategy strategy : {Strategy::Both, Strategy::EquiangularOnly, Strategy::FlightOnly}) {
            const Mean seen = seen_past({0.5f, 0.0, foot}, strategy, 64, view::Renderer::PathTracing);
            EXPECT_TRUE(std::isfinite(seen.value)) << foot;
            EXPECT_GE(seen.value, 0.0) << foot;
        }
    }
}

}  // namespace
}  // namespace tessera::embree
