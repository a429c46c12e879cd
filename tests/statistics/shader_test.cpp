// CommonSurfaceShader in pictures: every field against a closed form or another picture.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

using scene::SurfaceShader;

SurfaceShader black() {
    return {.diffuse = glm::vec3(0.0f)};
}

double channel(const PathSample& sample, int index) {
    return double(radiance_of(sample)[index]);
}

// With 4.5 standard errors for the few dozen comparisons here.
void expect_same(const Mean& a, const Mean& b, const char* what) {
    EXPECT_NEAR(a.value, b.value, 4.5 * std::hypot(a.standard_error, b.standard_error) + 1e-5) << what;
}

view::View ball_view() {
    view::View view = small_view({0, 0, 6}, 0.5);
    view.max_bounces = view.max_specular_bounces = view::UnlimitedBounces;
    return view;
}

// ---- energy ----

TEST(ShaderFurnace, ClearGlassAndMirrorsAreInvisible) {
    for (const glm::vec3 index : {glm::vec3(1.5f), glm::vec3(1.4f, 1.5f, 1.6f), glm::vec3(1.0f + 1e-6f)}) {
        for (const Normals normals : {Normals::Flat, Normals::Smooth}) {
            Model model;
            SurfaceShader glass = black();
            glass.reflection = glass.transmission = glm::vec3(1.0f);
            glass.relative_index_of_refraction = index;
            model.sphere(model.shader(glass), {0, 0, 0}, 1.0, normals);
            model.sky(glm::vec3(1.0f));
            const SceneAdapter& world = model.build();
            EXPECT_TRUE(model.problems.empty());
            for (int c = 0; c < 3; ++c) {
                const Mean mean =
                    mean_of(world, ball_view(), 64, [&](const PathSample& s) { return channel(s, c); });
                EXPECT_NEAR(mean.value, 1.0, 4.5 * mean.standard_error + 1e-5) << index.x << " " << c;
                EXPECT_LT(mean.standard_error, 0.02);
            }
        }
    }
}

TEST(ShaderFurnace, ConservesEnergy) {
    for (const float shininess : {0.0f, 0.1f, 4.0f}) {
        for (const float blend : {0.0f, 1.0f}) {
            Model model;
            model.sphere(model.shader({.diffuse = glm::vec3(0.9f),
                                       .specular = glm::vec3(0.9f),
                                       .shininess = {shininess, 0.5f},
                                       .reflection = glm::vec3(0.6f),
                                       .transmission = glm::vec3(0.3f),
                                       .relative_index_of_refraction = glm::vec3(1.5f),
                                       .fresnel_blend = blend}),
                         {0, 0, 0}, 1.0, Normals::Smooth);
            model.sky(glm::vec3(1.0f));
            const Mean mean = mean_of(model.build(), ball_view(), 64, red);
            EXPECT_LE(mean.value, 1.0 + 4.5 * mean.standard_error) << shininess << " " << blend;
            EXPECT_GT(mean.value, 0.5) << shininess << " " << blend;
        }
    }
}

// ---- fields ----

// A diffuse wall in a white sky: kd; the glossy lobe adds ks where it is narrow.
TEST(ShaderFields, DiffuseAndGlossyMatchTheirAlbedo) {
    for (const float ks : {0.0f, 0.3f}) {
        Model model;
        model.floor(
            model.shader(
                {.diffuse = {0.5f, 0.25f, 0.125f}, .specular = glm::vec3(ks), .shininess = glm::vec2(64.0f)}),
            10.0f, 0.0f);
        model.sky(glm::vec3(1.0f));
        const SceneAdapter& world = model.build();
        for (int c = 0; c < 3; ++c) {
            const Mean mean = mean_of(world, small_view({0, 0, 1}, 0.1), 64,
                                      [&](const PathSample& s) { return channel(s, c); });
            EXPECT_NEAR(mean.value, 0.5 / (1 << c) + double(ks), 4.5 * mean.standard_error + 1e-3);
        }
    }
}

// kr (1 - b + b F) of the sky, and of the shader's own environment.
TEST(ShaderFields, MirrorsReflectTheSkyAndTheirOwnEnvironment) {
    for (const float blend : {0.0f, 0.25f, 1.0f}) {
        SurfaceShader mirror = black();
        mirror.reflection = {0.8f, 0.4f, 0.2f};
        mirror.relative_index_of_refraction = glm::vec3(1.5f);
        mirror.fresnel_blend = blend;
        mirror.environment = {0.0f, 1.0f, 3.0f};
        Model model;
        mirror.environment_texture = model.texture<float>(
            {.width = 1, .height = 1, .format = scene::TexelFormat::RgbFloat}, {0.5f, 0.5f, 0.5f});
        model.floor(model.shader(mirror), 10.0f, 0.0f);
        model.sky(glm::vec3(0.25f));
        const SceneAdapter& world = model.build();
        const double f = 0.04, weight = 1.0 - double(blend) * (1.0 - f);
        view::View view = small_view({0, 0, 1}, 0.01);
        for (int c = 0; c < 3; ++c) {
            const double expected =
                double(mirror.reflection[c]) * weight * (0.25 + 0.5 * double(mirror.environment[c]));
            const Mean mean = mean_of(world, view, 64, [&](const PathSample& s) { return channel(s, c); });
            EXPECT_NEAR(mean.value, expected, 4.5 * mean.standard_error + 1e-4) << blend << " " << c;
        }
    }
}

// What red, green and blue see through a ball is what they see through balls of their own index.
TEST(ShaderFields, EachChannelIsRefractedByItsOwnIndex) {
    const glm::vec3 index{1.2f, 1.5f, 1.9f};
    const auto picture = [](const glm::vec3& of_glass, view::Renderer renderer, int c) {
        Model model;
        SurfaceShader glass = black();
        glass.reflection = glass.transmission = glm::vec3(1.0f);
        glass.relative_index_of_refraction = of_glass;
        model.sphere(model.shader(glass), {0, 0, 0}, 1.0, Normals::Smooth, 48);
        model.floor(model.shader({.emission = {1.0f, 2.0f, 4.0f}, .diffuse = glm::vec3(0.0f)}), 0.9f, -3.0f);
        view::View view = ball_view();
        view.renderer = renderer;
        return mean_of(model.build(), view, renderer == view::Renderer::Whitted ? 48 : 256,
                       [&](const PathSample& s) { return channel(s, c); });
    };
    for (int c = 0; c < 3; ++c) {
        const Mean alone = picture(glm::vec3(index[c]), view::Renderer::PathTracing, c);
        expect_same(picture(index, view::Renderer::PathTracing, c), alone, "paths");
        expect_same(picture(index, view::Renderer::Whitted, c), alone, "branches");
    }
    // They differ by more than that.
    EXPECT_GT(std::fabs(picture(glm::vec3(1.2f), view::Renderer::PathTracing, 0).value -
                        picture(glm::vec3(1.9f), view::Renderer::PathTracing, 0).value),
              0.02);
}

TEST(ShaderFields, OpacityIsFactorTimesTexel) {
    for (const bool inverted : {false, true}) {
        SurfaceShader sheer = black();
        sheer.alpha = 0.5f;
        sheer.invert_alpha_texture = inverted;
        Model model;
        sheer.alpha_texture = model.texture<std::uint8_t>({.width = 1, .height = 1}, {255, 255, 255, 51});
        model.textured_quad(model.shader(sheer), {{{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}}, 1.0f);
        model.sky(glm::vec3(1.0f));
        const Mean opacity = mean_of(model.build(), small_view({0, 0, 1}, 0.1), 256,
                                     [](const PathSample& s) { return double(s.alpha); });
        EXPECT_NEAR(opacity.value, inverted ? 0.4 : 0.1, 4.5 * opacity.standard_error);
    }
}

// ---- normals ----

using Corners = std::array<glm::vec3, 4>;
const Corners Wall{{{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}}};

glm::dvec3 normal_of(Model& model) {
    glm::dvec3 sum(0.0);
    for_samples(model.build(), small_view({0.1, 0.1, 1}, 0.001, 2), 1,
                [&](const PathSample& s) { sum += glm::dvec3(s.normal); });
    return 0.25 * sum;
}

void expect_normal(Model& model, const glm::dvec3& expected, double bound, const char* what) {
    const glm::dvec3 found = normal_of(model);
    EXPECT_LE(glm::length(found - glm::normalize(expected)), bound)
        << what << ": " << found.x << " " << found.y << " " << found.z;
}

// u grows to +x, v to +y, so the picture's up, where green points to, is -y.
TEST(ShaderNormals, ComeFromTheMapInItsFormatSpaceScaleAndBias) {
    struct Case {
        const char* what;
        std::array<std::uint8_t, 4> texel;
        SurfaceShader shader;
        glm::dvec3 expected;
    };
    const double step = 1.0 / 255.0;
    const Case cases[] = {
        {"unorm", {204, 102, 255, 255}, {}, {408 * step - 1, 1 - 204 * step, 1}},
        {"snorm",
         {64, 224, 127, 255},
         {.normal_format = scene::NormalFormat::Snorm,
          .normal_scale = glm::vec3(1.0f),
          .normal_bias = glm::vec3(0.0f)},
         {64.0 / 127, 32.0 / 127, 1}},
        {"snorm, the least number",
         {128, 0, 127, 255},
         {.normal_format = scene::NormalFormat::Snorm,
          .normal_scale = glm::vec3(1.0f),
          .normal_bias = glm::vec3(0.0f)},
         {-1, 0, 1}},
        {"object space",
         {204, 102, 255, 255},
         {.normal_space = scene::NormalSpace::Object},
         {408 * step - 1, 204 * step - 1, 1}},
        {"scale and bias",
         {204, 102, 255, 255},
         {.normal_scale = {1.0f, 2.0f, 0.5f}, .normal_bias = {-0.5f, 0.0f, 0.25f}},
         {204 * step - 0.5, -204 * step, 0.75}},
        {"tangents by a set", {204, 128, 255, 255}, {.tangent_tex_coords = 1}, {-step, 408 * step - 1, 1}},
    };
    for (const Case& c : cases) {
        Model model;
        SurfaceShader shader = c.shader;
        shader.normal_texture = model.texture<std::uint8_t>({.width = 1, .height = 1},
                                                            {c.texel[0], c.texel[1], c.texel[2], c.texel[3]});
        model.textured_quad(model.shader(shader), Wall, 1.0f);
        glm::dvec3 expected = c.expected;
        // u of the second set grows to +y: its bitangent, on the same side as the mesh's, is +x.
        if (shader.tangent_tex_coords == 1) expected.x = 256 * step - 1;
        expect_normal(model, expected, 1e-5, c.what);
    }
}

// The bitangent can have a separate set, not perpendicular to the tangent's.
TEST(ShaderNormals, BothAxesCanComeFromTexCoordSets) {
    Model model;
    SurfaceShader shader;
    shader.normal_texture = model.texture<std::uint8_t>({.width = 1, .height = 1}, {255, 204, 255, 255});
    shader.tangent_tex_coords = 0;
    shader.binormal_tex_coords = 1;
    model.textured_quad(model.shader(shader), Wall, 1.0f);
    expect_normal(model, {1.0, 408.0 / 255 - 1, 1}, 1e-5, "sets");
}

// A ramp of heights tilts the normal by its slope, whatever the scale of the world and of the texture.
TEST(ShaderNormals, FollowHeightMaps) {
    std::vector<float> ramp;
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 8; ++x) ramp.insert(ramp.end(), 3, 0.1f * float(x) + 0.3f * float(y));
    }
    for (const double size : {1e-6, 1.0, 1e6}) {
        for (const float repeats : {1.0f, 0.5f}) {
            Model model;
            model.scaled_by(size);
            SurfaceShader shader;
            shader.height_scale = float(size);
            shader.height_texture = model.texture<float>({.width = 8,
                                                          .height = 4,
                                                          .format = scene::TexelFormat::RgbFloat,
                                                          .wrap_s = scene::Wrap::Clamp,
                                                          .wrap_t = scene::Wrap::Clamp},
                                                         ramp);
            model.textured_quad(model.shader(shader), Wall, repeats);
            const SceneAdapter& world = model.build();
            view::View view = small_view(glm::dvec3(0.1, 0.1, 1) * size, 0.001, 2);
            glm::dvec3 sum(0.0);
            for_samples(world, view, 1, [&](const PathSample& s) { sum += 0.25 * glm::dvec3(s.normal); });
            // Texels per metre: 8 and 4, by `repeats` over the 8 m of the wall.
            const glm::dvec3 expected =
                glm::normalize(glm::dvec3(-0.1 * 8 * double(repeats) / 8, -0.3 * 4 * double(repeats) / 8, 1));
            EXPECT_LE(glm::length(sum - expected), 1e-4)
                << size << " " << repeats << ": " << sum.x << " " << sum.y;
        }
    }
}

// Along x and y each its own exponent: what a narrow light sees of the lobe is wider across the smooth side.
TEST(ShaderNormals, TwoExponentsFollowTheTangents) {
    const auto mean_at = [](const glm::dvec3& light) {
        Model model;
        model.textured_quad(
            model.shader(
                {.diffuse = glm::vec3(0.0f), .specular = glm::vec3(1.0f), .shininess = {4.0f, 0.1f}}),
            Wall, 1.0f);
        model.point_light(light, 1.0f);
        return mean_of(model.build(), small_view({0, 0, 4}, 0.01), 16, red).value;
    };
    EXPECT_GT(mean_at({0, 1.5, 4}), 3.0 * mean_at({1.5, 0, 4}));
}

}  // namespace
}  // namespace tessera::embree
