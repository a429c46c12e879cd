// Many lights: every sampling strategy agrees with the closed form.
#include <gtest/gtest.h>

#include "tests/statistics/panels.h"

namespace tessera::embree {
namespace {

TEST(ManyLights, PanelsAllAround) {
    const std::vector<Panel> panels = dome(15, 3.0, 1);
    for (const Sides sides : {Sides::One, Sides::Both}) {
        Model model;
        add_ground(model);
        add_panels(model, panels, sides);
        const SceneAdapter& world = model.build();
        double expected = reflected(panels);
        if (sides == Sides::Both) {
            expected = 0.0;
            for (const Panel& panel : panels) expected += GroundAlbedo / M_PI * irradiance_of(panel);
        }
        expect_light(seen_by(world, at_origin(0.3), Strategy::Both, 512), expected);
        expect_light(seen_by(world, at_origin(0.3), Strategy::LightsOnly, 512), expected);
        expect_light(seen_by(world, at_origin(0.3), Strategy::BsdfOnly, 1024), expected, 0.04);
    }
}

// Panels, bulbs, spots, a sun and a sky together.
TEST(ManyLights, OfAllKinds) {
    const std::vector<Panel> panels = dome(8, 3.0, 2);
    Model model;
    add_ground(model);
    add_panels(model, panels, Sides::One);
    double expected = reflected(panels);
    CounterRandom random(3);
    const glm::dmat4 id(1.0);
    for (int i = 0; i < 50; ++i) {
        const double phi = 2.0 * M_PI * random.uniform();
        const glm::dvec3 place(0.2 * std::cos(phi), 0.2 * std::sin(phi), 0.1 + 0.1 * random.uniform());
        const double cosine = place.z / glm::length(place);
        const auto intensity = static_cast<float>(0.1 * random.uniform());
        const double arrives = intensity * cosine / glm::dot(place, place);
        if (i % 2 == 0) {
            model.point_light(place, intensity);
            expected += GroundAlbedo / M_PI * arrives;
        } else {
            // Straight down: the origin is inside or outside the cone.
            const float outer = i % 4 == 1 ? 1.5f : 0.2f;
            model.light({.kind = scene::LightKind::Spot,
                         .intensity = glm::vec3(intensity),
                         .inner_cone_angle = outer - 0.1f,
                         .outer_cone_angle = outer},
                        glm::translate(id, place));
            if (outer > 1.0f) expected += GroundAlbedo / M_PI * arrives;
        }
    }
    model.light({.kind = scene::LightKind::Directional, .intensity = glm::vec3(1.5f)}, id);
    expected += GroundAlbedo / M_PI * 1.5;
    const SceneAdapter& world = model.build();
    expect_light(seen_by(world, at_origin(0.05), Strategy::Both, 2048), expected);
    expect_light(seen_by(world, at_origin(0.05), Strategy::LightsOnly, 2048), expected);
}

// A picture on a panel: its light is found by chance and on purpose alike.
TEST(ManyLights, ATexturedPanel) {
    Model model;
    add_ground(model, 3.0f);
    scene::Texture map{.width = 8, .height = 8, .format = scene::TexelFormat::RgbFloat};
    CounterRandom random(4);
    std::vector<glm::vec3> texels(64);
    for (glm::vec3& texel : texels) texel = glm::vec3(std::pow(random.uniform(), 8.0));
    scene::Material emissive = lamp(10.0f);
    emissive.emission_texture = model.texture(map, texels);
    const ObjectId screen = model.material(emissive);
    for (const float x : {-2.0f, 0.5f}) {
        model.textured_quad(
            screen, {{{x, -0.7f, 0.4f}, {x + 1.0f, -0.7f, 0.9f}, {x + 1.0f, 0.7f, 1.3f}, {x, 0.7f, 0.6f}}},
            1.7f);
    }
    const SceneAdapter& world = model.build();
    const Mean reference = seen_by(world, at_origin(0.3), Strategy::BsdfOnly, 4096);
    EXPECT_LE(reference.standard_error, 0.015 * reference.value);
    for (const Strategy strategy : {Strategy::Both, Strategy::LightsOnly}) {
        const Mean found = seen_by(world, at_origin(0.3), strategy, 1024);
        EXPECT_LE(found.standard_error, 0.005 * found.value);
        EXPECT_NEAR(found.value, reference.value,
                    4.0 * std::hypot(found.standard_error, reference.standard_error));
    }
}

TEST(ManyLights, LightsInHiddenLayersAreDark) {
    const std::vector<Panel> panels = dome(10, 3.0, 5);
    const std::vector<Panel> shown(panels.begin(), panels.begin() + 50),
        hidden(panels.begin() + 50, panels.end());
    Model model;
    add_ground(model);
    add_panels(model, shown, Sides::One);
    add_panels(model, hidden, Sides::One, 2);
    const SceneAdapter& world = model.build();
    view::View view = at_origin(0.3);
    expect_light(seen_by(world, view, Strategy::Both, 1024), reflected(panels));
    view.layers = 1;
    expect_light(seen_by(world, view, Strategy::Both, 2048), reflected(shown));
    expect_light(seen_by(world, view, Strategy::LightsOnly, 2048), reflected(shown));
}

}  // namespace
}  // namespace tessera::embree
