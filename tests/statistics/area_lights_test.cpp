// Area lights without geometry: spheres, quads and sun disks.
#include <gtest/gtest.h>

#include "tests/statistics/panels.h"

namespace tessera::embree {
namespace {

using scene::LightKind;

glm::dmat4 at(const glm::dvec3& place) {
    return glm::translate(glm::dmat4(1.0), place);
}

void expect_by_all(const SceneAdapter& world, double expected, double height = 0.3) {
    for (const Strategy strategy : {Strategy::Both, Strategy::LightsOnly}) {
        expect_light(seen_by(world, at_origin(height), strategy, 1024), expected);
    }
    expect_light(seen_by(world, at_origin(height), Strategy::BsdfOnly, 1024), expected, 0.04);
}

// From outside a sphere equals a point light, as long as all of it is above the horizon.
TEST(AreaLights, ASphereAboveAPlane) {
    for (const glm::dvec3 place : {glm::dvec3(0.0, 0.0, 2.0), glm::dvec3(1.0, -0.5, 1.5)}) {
        Model model;
        add_ground(model);
        model.light({.kind = LightKind::Sphere, .intensity = glm::vec3(5.0f), .radius = 0.8f},
                    glm::scale(at(place), glm::dvec3(3.0)));
        const double distance2 = glm::dot(place, place);
        expect_by_all(model.build(), GroundAlbedo / M_PI * 5.0 / distance2 * place.z / std::sqrt(distance2));
    }
}

TEST(AreaLights, InsideASphereLight) {
    for (const double off : {0.0, 0.7}) {
        Model model;
        add_ground(model);
        model.light({.kind = LightKind::Sphere, .intensity = glm::vec3(3.0f), .radius = 2.0f},
                    at({off, off, 0.2}));
        expect_by_all(model.build(), GroundAlbedo * 3.0 / (M_PI * 4.0));
    }
}

TEST(AreaLights, AQuadAboveAPlane) {
    for (const bool turned : {false, true}) {
        Model model;
        add_ground(model);
        const glm::dmat4 place =
            at({0.4, 0.2, 1.0}) *
            (turned ? glm::rotate(glm::dmat4(1.0), 0.7, {1.0, 0.3, 0.0}) : glm::dmat4(1.0));
        model.light({.kind = LightKind::Quad, .intensity = glm::vec3(4.0f), .size = {0.6f, 1.4f}}, place);
        std::array<glm::vec3, 4> c;
        for (std::size_t i = 0; i < 4; ++i) {
            const double x = i == 0 || i == 3 ? -0.3 : 0.3, y = i < 2 ? -0.7 : 0.7;
            c[i] = glm::vec3(place * glm::dvec4(x, y, 0.0, 1.0));
        }
        const double radiance = 4.0 / (0.6 * 1.4);
        expect_by_all(model.build(), GroundAlbedo / M_PI *
                                         (irradiance_of({{c[0], c[1], c[2]}, radiance}) +
                                          irradiance_of({{c[0], c[2], c[3]}, radiance})));
    }
}

TEST(AreaLights, AQuadIsDarkFromBehindOrWithZeroArea) {
    Model model;
    add_ground(model);
    model.light({.kind = LightKind::Quad},
                at({0.0, 0.0, 1.0}) * glm::rotate(glm::dmat4(1.0), M_PI, {1.0, 0.0, 0.0}));
    model.light({.kind = LightKind::Quad, .size = {1.0f, 0.0f}}, at({0.0, 0.0, 1.0}));
    const SceneAdapter& world = model.build();
    for (const Strategy strategy : {Strategy::Both, Strategy::BsdfOnly}) {
        EXPECT_EQ(seen_by(world, at_origin(0.3), strategy, 16).value, 0.0);
    }
}

TEST(AreaLights, ASunDisk) {
    for (const float angle : {0.0f, 1e-6f, 0.0044f, 0.3f}) {
        Model model;
        add_ground(model);
        model.light({.kind = LightKind::Directional, .intensity = glm::vec3(2.0f), .angle = angle},
                    glm::rotate(glm::dmat4(1.0), 0.8, {1.0, 0.0, 0.0}));
        const SceneAdapter& world = model.build();
        const double expected = GroundAlbedo / M_PI * 2.0 * std::cos(0.8);
        for (const Strategy strategy : {Strategy::Both, Strategy::LightsOnly}) {
            expect_light(seen_by(world, at_origin(0.3), strategy, 128), expected);
        }
        if (angle == 0.3f)
            expect_light(seen_by(world, at_origin(0.3), Strategy::BsdfOnly, 1024), expected, 0.04);
    }
}

// All kinds together, with panels and a sky.
TEST(AreaLights, AmongOtherLights) {
    const std::vector<Panel> panels = dome(6, 3.0, 12);
    Model model;
    add_ground(model);
    add_panels(model, panels, Sides::One);
    model.sky(glm::vec3(0.2f));
    model.light({.kind = LightKind::Sphere, .intensity = glm::vec3(0.3f), .radius = 0.2f},
                at({0.3, 0.1, 0.5}));
    model.light({.kind = LightKind::Quad, .intensity = glm::vec3(0.3f), .size = {0.5f, 0.5f}},
                at({-0.3, 0.0, 0.6}));
    model.light({.kind = LightKind::Directional, .intensity = glm::vec3(0.5f), .angle = 0.1f},
                glm::dmat4(1.0));
    const SceneAdapter& world = model.build();
    const Mean both = seen_by(world, at_origin(0.2), Strategy::Both, 2048);
    for (const Strategy other : {Strategy::LightsOnly, Strategy::BsdfOnly}) {
        const Mean found = seen_by(world, at_origin(0.2), other, 2048);
        EXPECT_LE(found.standard_error, 0.02 * both.value);
        EXPECT_NEAR(found.value, both.value, 4.0 * std::hypot(found.standard_error, both.standard_error));
    }
}

double first_sample(const SceneAdapter& world, const view::View& view) {
    const PathTracer tracer(world.tables(), world.scene(), view);
    std::uint64_t rays = 0;
    return red(tracer.trace(8, 8, 0, rays));
}

// The camera sees the emission of a sphere and a quad plus that of the surface behind them.
TEST(AreaLights, AreVisibleAndDoNotOcclude) {
    for (const view::Renderer renderer : {view::Renderer::PathTracing, view::Renderer::Whitted}) {
        Model model;
        model.floor(model.material(lamp(1.0f)), 1.0f, 0.0f);
        model.light({.kind = LightKind::Sphere, .intensity = glm::vec3(0.25f), .radius = 0.1f},
                    at({0, 0, 1}));
        model.light({.kind = LightKind::Quad, .intensity = glm::vec3(0.5f), .size = {0.5f, 0.5f}},
                    at({0, 0, 2}) * glm::rotate(glm::dmat4(1.0), M_PI, {1.0, 0.0, 0.0}));
        const SceneAdapter& world = model.build();
        view::View view = at_origin(3.0);
        view.renderer = renderer;
        const double sphere = 0.25 / (M_PI * 0.01), quad = 0.5 / 0.25;
        EXPECT_NEAR(first_sample(world, view), 1.0 + sphere + quad, 1e-5);
        view.camera = at_origin(1.5).camera;
        EXPECT_NEAR(first_sample(world, view), 1.0 + sphere, 1e-5);
        view.camera = at_origin(1.0).camera;
        EXPECT_NEAR(first_sample(world, view), 1.0 + sphere, 1e-5) << "from its center";
        view.camera = at_origin(0.5).camera;
        EXPECT_NEAR(first_sample(world, view), 1.0, 1e-5) << "it is behind";
    }
}

TEST(AreaLights, AreVisibleInMirrors) {
    Model model;
    model.floor(model.material(mirror(glm::vec3(1.0f))), 1.0f, 0.0f);
    model.light({.kind = LightKind::Sphere, .intensity = glm::vec3(0.25f), .radius = 0.1f}, at({0, 0, 2}));
    model.light({.kind = LightKind::Directional, .intensity = glm::vec3(0.5f), .angle = 0.01f},
                glm::dmat4(1.0));
    const SceneAdapter& world = model.build();
    view::View view = at_origin(1.0);
    view.max_bounces = 4;
    const double sun = 0.5 / (M_PI * std::pow(std::sin(0.01), 2.0)), sphere = 0.25 / (M_PI * 0.01);
    EXPECT_NEAR(first_sample(world, view) / (sun + sphere), 1.0, 1e-5);
    view.layers = 2;
    EXPECT_EQ(first_sample(world, view), 0.0) << "all of it is in another layer";
}

TEST(AreaLights, AQuadEmitsNothingOutsideItsCorners) {
    Model model;
    model.light({.kind = LightKind::Quad, .intensity = glm::vec3(1.0f), .size = {2.0f, 1.0f}}, at({0, 0, 0}));
    const SceneAdapter& world = model.build();
    const auto sees = [&](double x, double y) {
        view::View view =
            small_view({x, y, -1.0}, 1e-3, 16, glm::rotate(glm::dmat4(1.0), M_PI, {0.0, 1.0, 0.0}));
        return first_sample(world, view) > 0.0;
    };
    EXPECT_TRUE(sees(0.99, 0.49));
    EXPECT_TRUE(sees(-0.99, -0.49));
    EXPECT_FALSE(sees(1.01, 0.0));
    EXPECT_FALSE(sees(0.0, 0.51));
}

}  // namespace
}  // namespace tessera::embree
