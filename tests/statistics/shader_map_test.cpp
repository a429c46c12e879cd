// CommonSurfaceShader: factor textures, tangent frames of its maps, and glass seen from inside.
#include <gtest/gtest.h>

#include <cmath>

#include "mediator/shading/fresnel.h"
#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

using scene::SurfaceShader;
using test::Tangents;

using Corners = std::array<glm::vec3, 4>;
const Corners MappedWall{{{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}}};

constexpr double Step = 1.0 / 255.0;

scene::TextureSlot texel(Model& model, const std::array<std::uint8_t, 4>& bytes) {
    return model.texture<std::uint8_t>({.width = 1, .height = 1}, {bytes[0], bytes[1], bytes[2], bytes[3]});
}

// ---- factors ----

// What a wall of this shader shows under a white sky; its alpha is that of the texture, which is not opacity.
Mean under_a_sky(SurfaceShader shader, scene::TextureSlot SurfaceShader::*slot) {
    Model model;
    shader.diffuse = glm::vec3(0.0f);
    shader.*slot = texel(model, {51, 51, 51, 255});
    model.textured_quad(model.shader(shader), MappedWall, 1.0f);
    model.sky(glm::vec3(1.0f));
    return mean_of(model.build(), small_view({0, 0, 1}, 0.1), 64, red);
}

TEST(ShaderFactors, AreMultipliedByTheirTexels) {
    const auto expect_fifth = [](const Mean& mean, double factor, const char* what) {
        EXPECT_NEAR(mean.value, 0.2 * factor, 4.5 * mean.standard_error + 2e-3 * factor) << what;
    };
    // Shininess 512 is Blinn's exponent 65536, which loses nothing.
    const SurfaceShader glossy{.specular = glm::vec3(0.75f), .shininess = glm::vec2(512.0f)};
    expect_fifth(under_a_sky(glossy, &SurfaceShader::specular_texture), 0.75, "specular");
    const SurfaceShader mirror{.reflection = glm::vec3(0.75f), .fresnel_blend = 0.0f};
    expect_fifth(under_a_sky(mirror, &SurfaceShader::reflection_texture), 0.75, "reflection");
    const SurfaceShader clear{.transmission = glm::vec3(0.75f),
                              .relative_index_of_refraction = glm::vec3(1.0f),
                              .fresnel_blend = 0.0f};
    expect_fifth(under_a_sky(clear, &SurfaceShader::transmission_texture), 0.75, "transmission");
}

// Alpha of its texture times shininess is the shininess that counts.
TEST(ShaderFactors, ShininessIsMultipliedByAlpha) {
    const auto lit = [](float shininess, std::uint8_t alpha) {
        Model model;
        SurfaceShader shader{
            .diffuse = glm::vec3(0.0f), .specular = glm::vec3(1.0f), .shininess = glm::vec2(shininess)};
        shader.shininess_texture = texel(model, {0, 0, 0, alpha});
        model.textured_quad(model.shader(shader), MappedWall, 1.0f);
        model.point_light({1.0, 0.0, 4.0}, 1.0f);
        return mean_of(model.build(), small_view({0, 0, 4}, 0.01), 16, red).value;
    };
    EXPECT_NEAR(lit(1.0f, 51) / lit(0.2f, 255), 1.0, 1e-3);
    EXPECT_GT(std::fabs(lit(1.0f, 255) / lit(0.2f, 255) - 1.0), 0.5) << "they differ";
}

// ---- frames ----

void expect_normal(Model& model, const glm::dvec3& expected, const char* what) {
    glm::dvec3 sum(0.0);
    for_samples(model.build(), small_view({0.1, 0.1, 1}, 0.001, 2), 1,
                [&](const PathSample& s) { sum += 0.25 * glm::dvec3(s.normal); });
    EXPECT_LE(glm::length(sum - glm::normalize(expected)), 1e-4)
        << what << ": " << sum.x << " " << sum.y << " " << sum.z;
}

SurfaceShader mapped(Model& model, scene::NormalSpace space) {
    SurfaceShader shader{.normal_space = space};
    shader.normal_texture = texel(model, {204, 102, 255, 255});
    return shader;
}

// Without mesh tangents they are along u, and green points against v; of a mirrored wall, whose
// triangles have the opposite winding, as well.
TEST(ShaderFrames, FollowTextureCoordinatesWhereThereAreNoTangents) {
    const double red = 408 * Step - 1, green = 1 - 204 * Step;
    Model plain;
    plain.textured_quad(plain.shader(mapped(plain, scene::NormalSpace::Tangent)), MappedWall, 1.0f,
                        Tangents::None);
    expect_normal(plain, {red, green, 1}, "plain");
    Model mirrored;
    mirrored.set_frame(glm::scale(glm::dmat4(1.0), {-1.0, 1.0, 1.0}));
    mirrored.textured_quad(mirrored.shader(mapped(mirrored, scene::NormalSpace::Tangent)), MappedWall, 1.0f,
                           Tangents::None);
    expect_normal(mirrored, {-red, green, 1}, "mirrored");
    Model turned;
    turned.set_frame(glm::scale(glm::dmat4(1.0), {-1.0, -1.0, 1.0}));
    turned.textured_quad(turned.shader(mapped(turned, scene::NormalSpace::Tangent)), MappedWall, 1.0f,
                         Tangents::None);
    expect_normal(turned, {-red, -green, 1}, "turned by half");
}

// As glTF has it: tangents are the mesh's, and a mirrored instance shows the mirrored picture.
TEST(ShaderFrames, AreMirroredWithTheirInstance) {
    const double red = 408 * Step - 1, green = 1 - 204 * Step;
    const auto wall = [](Model& model) {
        scene::Material material;
        material.normal_texture = texel(model, {204, 102, 255, 255});
        model.textured_quad(model.material(material), MappedWall, 1.0f, Tangents::Given);
    };
    Model plain;
    wall(plain);
    expect_normal(plain, {red, green, 1}, "plain");
    Model mirrored;
    mirrored.set_frame(glm::scale(glm::dmat4(1.0), {-1.0, 1.0, 1.0}));
    wall(mirrored);
    expect_normal(mirrored, {-red, green, 1}, "mirrored");
    Model upside_down;
    upside_down.set_frame(glm::scale(glm::dmat4(1.0), {1.0, -1.0, 1.0}));
    wall(upside_down);
    expect_normal(upside_down, {red, -green, 1}, "upside down");
    Model turned;
    turned.set_frame(glm::scale(glm::dmat4(1.0), {-1.0, -1.0, 1.0}));
    wall(turned);
    expect_normal(turned, {-red, -green, 1}, "turned by half");
}

// Normals of object space turn with the object and, stretched, stay at right angles to what they were.
TEST(ShaderFrames, ObjectSpaceIsTheObjects) {
    const double x = 408 * Step - 1, y = 204 * Step - 1;
    Model turned;
    turned.set_frame(glm::rotate(glm::dmat4(1.0), M_PI / 2, {0.0, 0.0, 1.0}));
    turned.textured_quad(turned.shader(mapped(turned, scene::NormalSpace::Object)), MappedWall, 1.0f);
    expect_normal(turned, {-y, x, 1}, "turned");
    Model stretched;
    stretched.set_frame(glm::scale(glm::dmat4(1.0), {2.0, 1.0, 1.0}));
    stretched.textured_quad(stretched.shader(mapped(stretched, scene::NormalSpace::Object)), MappedWall,
                            1.0f);
    expect_normal(stretched, {0.5 * x, y, 1}, "stretched");
}

// Heights of a picture that is scaled and turned have slopes that are.
TEST(ShaderFrames, HeightsFollowTheTransformOfTheirTexture) {
    std::vector<float> ramp;
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 8; ++x) ramp.insert(ramp.end(), 3, 0.1f * float(x) + 0.3f * float(y));
    }
    Model model;
    SurfaceShader shader{.height_scale = 1.0f};
    shader.height_texture = model.texture<float>({.width = 8,
                                                  .height = 4,
                                                  .format = scene::TexelFormat::RgbFloat,
                                                  .wrap_s = scene::Wrap::Clamp,
                                                  .wrap_t = scene::Wrap::Clamp},
                                                 ramp);
    constexpr double Angle = 0.3;
    const glm::dvec2 scale(1.5, 0.5);
    shader.height_texture.rotation = float(Angle);
    shader.height_texture.scale = glm::vec2(scale);
    shader.height_texture.offset = {-0.3f, 0.4f};
    model.textured_quad(model.shader(shader), MappedWall, 1.0f);
    // Per unit of the picture, and of the wall's 8 m: 8 steps of 0.1 and 4 of 0.3.
    const double c = std::cos(Angle), s = std::sin(Angle);
    const double along_u = scale.x * (0.8 * c - 1.2 * s), along_v = scale.y * (0.8 * s + 1.2 * c);
    expect_normal(model, {-along_u / 8, -along_v / 8, 1}, "heights");
}

// ---- glass ----

// As glTF's glass in specular_test: the light of a slab's floor is shifted by its two sides, of which the
// lower one is seen from inside.
TEST(ShaderGlass, IsRefractedBackWhereItLeaves) {
    for (const double n : {1.33, 1.8}) {
        Model model;
        SurfaceShader glass{.diffuse = glm::vec3(0.0f)};
        glass.reflection = glass.transmission = glm::vec3(1.0f);
        glass.relative_index_of_refraction = glm::vec3(float(n));
        const ObjectId slab = model.shader(glass);
        model.floor(slab, 50.0f, 1.0f);
        model.floor(slab, -50.0f, 0.5f);
        const ObjectId ruler = model.material({.base_color = {1, 1, 1, 1}, .unlit = true});
        model.floor(ruler, 10.0f, 0.0f, {{0, 1, 0, 1}, {1, 1, 0, 1}, {1, 1, 0, 1}, {0, 1, 0, 1}});
        constexpr double Angle = 0.7;
        double place = 0.0, seen = 0.0;
        for_samples(
            model.build(),
            small_view({0.0, 0.0, 3.0}, 1e-4, 8, glm::rotate(glm::dmat4(1.0), -Angle, {0.0, 1.0, 0.0})), 64,
            [&](const PathSample& sample) {
                place += double(radiance_of(sample).x);
                seen += double(radiance_of(sample).y);
            });
        const double f = double(shading::fresnel_dielectric(float(std::cos(Angle)), float(n)));
        const double inside = std::tan(std::asin(std::sin(Angle) / n)) * (1.0 + f * f) / (1.0 - f * f);
        EXPECT_NEAR(place / seen * 20.0 - 10.0, 2.5 * std::tan(Angle) + 0.5 * inside, 2e-3) << n;
        EXPECT_NEAR(seen / (64 * 64), (1.0 - f) / (1.0 + f), 0.02) << n;
    }
}

}  // namespace
}  // namespace tessera::embree
