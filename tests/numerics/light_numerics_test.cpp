// Lights of extreme sizes, powers and positions, against closed forms in double.
#include <gtest/gtest.h>

#include "tests/statistics/panels.h"

namespace tessera::embree {
namespace {

// At height h above the origin, facing it, of edge length s.
Panel above(float h, float s, double radiance) {
    return {{{{-0.5f * s, -0.5f * s, h}, {-0.5f * s, 0.5f * s, h}, {0.5f * s, -0.5f * s, h}}}, radiance};
}

TEST(LightNumerics, EmittersOfAMicrometre) {
    std::vector<Panel> panels;
    for (int i = 0; i < 64; ++i) {
        Panel panel = above(2.0f, 1e-6f, 1e12);
        for (glm::vec3& corner : panel.corners) {
            corner.x += 1e-5f * static_cast<float>(i % 8) - 3.5e-5f;
            corner.y += 1e-5f * static_cast<float>(i / 8) - 3.5e-5f;
        }
        panels.push_back(panel);
    }
    Model model;
    add_ground(model);
    add_panels(model, panels, Sides::One);
    const SceneAdapter& world = model.build();
    for (const Strategy strategy : {Strategy::Both, Strategy::LightsOnly}) {
        expect_light(seen_by(world, at_origin(0.3), strategy, 16), reflected(panels));
    }
}

// A floodlight of 100 m and a spark of 1e-6 m near the ground; either can be the brighter one.
TEST(LightNumerics, AHugeAndATinyEmitter) {
    for (const double tiny : {1e6, 1e10, 1e14}) {
        const Panel flood{{{{-50.0f, -50.0f, 40.0f}, {-50.0f, 50.0f, 40.0f}, {50.0f, -50.0f, 40.0f}}}, 1.0};
        const Panel spark = above(0.5f, 1e-6f, tiny);
        Model model;
        add_ground(model);
        add_panels(model, {flood, spark}, Sides::One);
        const SceneAdapter& world = model.build();
        // The eye looks from the side, so that nothing is between eye and spark.
        expect_light(seen_by(world, at_origin(0.3), Strategy::Both, 1024), reflected({flood, spark}));
    }
}

TEST(LightNumerics, FarFromTheRenderOrigin) {
    const std::vector<Panel> panels = dome(6, 3.0, 6);
    const glm::dvec3 origin(4.0e6, -2.5e6, 1.0e6);
    Model model(origin);
    // Everything there, in one transform for each: vertices stay small.
    const scene::Material ground = chalk(glm::vec3(GroundAlbedo));
    model.placed_at(origin);
    model.floor(model.material(ground), 1.0f, 0.0f);
    add_panels(model, panels, Sides::One);
    const SceneAdapter& world = model.build();
    view::View view = small_view(origin + glm::dvec3(0.0, 0.0, 0.3), 1e-3);
    view.max_bounces = 0;
    expect_light(seen_by(world, view, Strategy::Both, 1024), reflected(panels));
}

TEST(LightNumerics, ScenesOfAnySize) {
    for (const double size : {1e-12, 1e-6, 1e6, 1e12}) {
        const std::vector<Panel> panels = dome(6, 3.0, 7);
        Model model;
        model.scaled_by(size);
        add_ground(model);
        add_panels(model, panels, Sides::One);
        const SceneAdapter& world = model.build();
        SCOPED_TRACE(size);
        for (const Strategy strategy : {Strategy::Both, Strategy::LightsOnly}) {
            expect_light(seen_by(world, at_origin(0.3 * size), strategy, 1024), reflected(panels));
        }
    }
}

// Emitters among which some have no area or emission, or face away from the ground.
TEST(LightNumerics, DegenerateDarkAndBackFacingEmitters) {
    std::vector<Panel> panels = dome(6, 3.0, 8);
    const double expected = reflected(panels);
    for (std::size_t i = 0; i < 10; ++i) {
        Panel line = panels[i], dark = panels[i + 10];
        line.corners[2] = line.corners[1];
        dark.radiance = 0.0;
        for (glm::vec3& corner : dark.corners) corner *= 1.5f;
        panels.push_back(line);
        panels.push_back(dark);
    }
    Model model;
    add_ground(model);
    add_panels(model, panels, Sides::One);
    expect_light(seen_by(model.build(), at_origin(0.3), Strategy::Both, 1024), expected);

    Panel back = above(2.0f, 0.5f, 7.0);
    std::swap(back.corners[0], back.corners[1]);
    Model behind;
    add_ground(behind);
    add_panels(behind, {back, back}, Sides::One);
    EXPECT_EQ(seen_by(behind.build(), at_origin(0.3), Strategy::Both, 16).value, 0.0);
}

// From outside a sphere light equals a point light, at any size and distance.
TEST(LightNumerics, SpheresOfAnySizeAtAnyDistance) {
    for (const double distance : {1e-9, 1.0, 1e9}) {
        for (const double ratio : {1e-12, 1e-6, 1e-3, 0.5, 0.999, 0.999999}) {
            Model model;
            add_ground(model, static_cast<float>(distance));
            const double radius = ratio * distance;
            model.light({.kind = scene::LightKind::Sphere,
                         .intensity = glm::vec3(static_cast<float>(distance * distance)),
                         .radius = static_cast<float>(radius)},
                        glm::translate(glm::dmat4(1.0), {0.0, 0.0, distance}));
            const SceneAdapter& world = model.build();
            SCOPED_TRACE(testing::Message() << distance << " " << ratio);
            for (const Strategy strategy : {Strategy::Both, Strategy::LightsOnly}) {
                // An eye inside the sphere sees its light, too.
                const double in_front = ratio > 0.7 ? 1.0 / (M_PI * ratio * ratio) : 0.0;
                expect_light(seen_by(world, at_origin(0.3 * distance), strategy, 256),
                             GroundAlbedo / M_PI + in_front);
            }
        }
    }
}

// 0.25 degrees across, radiance 1e9, in a sky of 0.01: as a directional light and as a texel of a map.
TEST(LightNumerics, AnIntenseSunDiskInADimSky) {
    const double half_angle = 0.125 / 180.0 * M_PI;
    const double irradiance = 1e9 * M_PI * std::pow(std::sin(half_angle), 2.0);
    Model model;
    add_ground(model);
    model.sky(glm::vec3(0.01f));
    model.light({.kind = scene::LightKind::Directional,
                 .intensity = glm::vec3(static_cast<float>(irradiance)),
                 .angle = static_cast<float>(half_angle)},
                glm::dmat4(1.0));
    expect_light(seen_by(model.build(), at_origin(0.3), Strategy::Both, 64),
                 GroundAlbedo * (0.01 + irradiance / M_PI));
}

TEST(LightNumerics, AnIntenseSunInAnEnvironmentMap) {
    constexpr std::uint32_t Width = 1440, Height = 720;  // a quarter of a degree each
    constexpr std::uint32_t Column = 400, Row = 250;
    std::vector<glm::vec3> texels(std::size_t{Width} * Height, glm::vec3(0.01f));
    texels[std::size_t{Row} * Width + Column] = glm::vec3(1e9f);
    // The map's +y is up there; here up is +z: the ground is vertical.
    Model model;
    model.quad(model.material(chalk(glm::vec3(GroundAlbedo))),
               {{{-1.0f, 0.0f, 1.0f}, {1.0f, 0.0f, 1.0f}, {1.0f, 0.0f, -1.0f}, {-1.0f, 0.0f, -1.0f}}});
    scene::Texture map{.width = Width, .height = Height, .format = scene::TexelFormat::RgbFloat};
    const scene::TextureSlot slot = model.texture(map, texels);
    model.sky(scene::Background{.environment = slot.texture});
    const SceneAdapter& world = model.build();
    // Bilinear filtering spreads the texel as a tent over two texels in each direction.
    double sun = 0.0;
    constexpr int Steps = 2000;
    for (int i = 0; i < Steps; ++i) {
        const double v = 2.0 * (i + 0.5) / Steps - 1.0;
        const double theta = M_PI * (Row + 0.5 + v) / Height;
        sun += (1.0 - std::fabs(v)) * std::sin(theta) * std::cos(theta) * 2.0 / Steps;
    }
    sun *= (1e9 - 0.01) * (M_PI / Height) * (2.0 * M_PI / Width);
    view::View view =
        small_view({0.0, 0.3, 0.0}, 1e-3, 16, glm::rotate(glm::dmat4(1.0), -M_PI / 2, {1.0, 0.0, 0.0}));
    view.max_bounces = 0;
    expect_light(seen_by(world, view, Strategy::Both, 1024), GroundAlbedo * (0.01 + sun / M_PI));
}

}  // namespace
}  // namespace tessera::embree
