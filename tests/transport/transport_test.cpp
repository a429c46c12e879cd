// Whole samples, with brute-force rays: the same on the device as in C++.
#include <cmath>
#include <cstdio>
#include <glm/gtc/matrix_transform.hpp>

#include "mediator/backend/tables/media.h"
#include "mediator/backend/tables/view_record.h"
#include "mediator/base/random.h"
#include "mediator/shading/sample_values.h"
#include "mediator/shading/trace.h"
#include "tests/statistics/scene_model.h"
#include "tests/transport/brute_force.h"
#include "tests/transport/device_scene.h"
#include "tests/transport/transport.comp.h"
#include "tests/vulkan/vulkan_test.h"

namespace tessera::vulkan {
namespace {

using test::Normals;
using test::SceneModel;

constexpr std::uint32_t Size = 32, SamplesPerPixel = 2;
constexpr frame::ChannelSet AllChannels = frame::ChannelSet::all();

scene::TextureSlot checker(SceneModel& model, std::uint32_t dark, std::uint32_t light, scene::Wrap wrap) {
    const scene::Texture texture{
        .width = 2, .height = 2, .format = scene::TexelFormat::Rgba8Srgb, .wrap_s = wrap, .wrap_t = wrap};
    return model.texture(texture, std::vector<std::uint32_t>{dark, light, light, dark});
}

constexpr std::array<glm::vec3, 4> Ground{{{-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}}};

glm::dmat4 pointing_down(const glm::dvec3& place) {
    return glm::rotate(glm::translate(glm::dmat4(1.0), place), -M_PI / 2, {1.0, 0.0, 0.0});
}

// A textured ground, a rough metal ball and a varnished one under every kind of light.
void lights_and_textures(SceneModel& model) {
    scene::Material tiles{.roughness = 0.5f};
    tiles.base_color_texture = checker(model, 0xff2040c0u, 0xffe0d0b0u, scene::Wrap::Mirror);
    tiles.base_color_texture.rotation = 0.3f;
    tiles.base_color_texture.offset = {0.1f, 0.7f};
    model.textured_quad(model.material(tiles), Ground, 5.0f);
    const ObjectId metal =
        model.material({.base_color = {0.9f, 0.7f, 0.3f, 1.0f}, .metallic = 1.0f, .roughness = 0.4f});
    model.sphere(metal, {-1.2, 1.0, 0.0}, 1.0, Normals::Smooth, 8);
    model.sphere(model.material({.roughness = 0.2f}), {1.2, 0.8, 0.0}, 0.8, Normals::Flat, 8);
    model.quad(model.material(test::lamp(6.0f)), {{{-1, 3, 1}, {1, 3, 1}, {1, 3, -1}, {-1, 3, -1}}});
    model.light({.kind = scene::LightKind::Point, .intensity = {5, 4, 3}}, pointing_down({2, 2, 2}));
    model.light({.kind = scene::LightKind::Spot, .intensity = {5, 9, 5}, .inner_cone_angle = 0.2f},
                pointing_down({-1, 4, 2}));
    model.light({.kind = scene::LightKind::Directional, .intensity = glm::vec3(0.4f)},
                pointing_down({0, 0, 0}));
}

// Balls among sphere and quad lights and 300 point lights, under two directional lights.
void lights_with_sizes(SceneModel& model) {
    model.quad(model.material(test::chalk(glm::vec3(0.7f))), Ground);
    model.sphere(model.material({.roughness = 0.2f}), {-1.2, 1.0, 0.0}, 1.0, Normals::Flat, 8);
    model.sphere(model.material(test::mirror(glm::vec3(0.9f))), {1.2, 0.8, 0.0}, 0.8, Normals::Smooth, 8);
    for (int i = 0; i < 300; ++i) {
        const glm::dvec3 place(std::sin(i * 1.7) * 3.0, 1.5 + std::sin(i * 0.3), std::cos(i * 2.3) * 3.0);
        const scene::LightKind kind = i % 10 == 0   ? scene::LightKind::Sphere
                                      : i % 10 == 5 ? scene::LightKind::Quad
                                                    : scene::LightKind::Point;
        model.light({.kind = kind, .intensity = glm::vec3(0.05f), .radius = 0.2f, .size = {0.3f, 0.5f}},
                    pointing_down(place));
    }
    for (const float angle : {0.0f, 0.2f}) {
        model.light({.kind = scene::LightKind::Directional, .intensity = glm::vec3(0.4f), .angle = angle},
                    pointing_down({0, 0, 0}));
    }
}

// A ball and a mirror on a shadow catcher, with a background that is not the environment.
void caught_shadows(SceneModel& model) {
    scene::Material ground = test::chalk(glm::vec3(0.7f));
    ground.base_color.w = 0.7f;
    ground.shadow_catcher = true;
    model.quad(model.material(ground), Ground);
    model.sphere(model.material({.roughness = 0.2f}), {-1.2, 1.0, 0.0}, 1.0, Normals::Flat, 8);
    model.sphere(model.material(test::mirror(glm::vec3(0.9f))), {1.2, 0.8, 0.0}, 0.8, Normals::Smooth, 8);
    model.sky({.color = {0.3f, 0.4f, 0.6f},
               .visible = scene::VisibleBackground::Color,
               .visible_color = {0.9f, 0.8f, 0.7f, 0.5f}});
}

// Glass, a mirror and a normal-mapped surface under an environment map.
void speculars_and_sky(SceneModel& model) {
    scene::Material waves{.base_color = {0.5f, 0.6f, 0.7f, 1.0f}, .metallic = 0.3f, .roughness = 0.3f};
    const scene::Texture normals{.width = 2, .height = 1};
    waves.normal_texture = model.texture(normals, std::vector<std::uint32_t>{0xffe08060u, 0xffe080a0u});
    model.textured_quad(model.material(waves), Ground, 3.0f);
    model.sphere(model.material(test::glass(1.5f, glm::vec3(0.9f, 1.0f, 0.9f))), {-1.1, 1.0, 0.5}, 1.0,
                 Normals::Smooth, 8);
    model.sphere(model.material(test::mirror(glm::vec3(0.9f))), {1.1, 1.0, 0.0}, 1.0, Normals::Smooth, 8);
    std::vector<glm::vec3> texels(8 * 4, glm::vec3(0.3f, 0.4f, 0.6f));
    texels[10] = {30.0f, 25.0f, 20.0f};
    const auto map = model.texture({.width = 8, .height = 4, .format = scene::TexelFormat::RgbFloat}, texels);
    model.sky({.color = glm::vec3(0.05f), .environment = map.texture, .strength = 0.8f, .rotation = 1.0f});
}

// Masked and blended quads, one of them emissive, and vertex colours.
void alpha_and_colors(SceneModel& model) {
    const ObjectId painted = model.material(test::chalk(glm::vec3(1.0f)));
    model.quad(painted, Ground, {{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}, {1, 1, 1, 1}});
    scene::Material mask{.alpha_mode = scene::AlphaMode::Mask, .double_sided = true};
    mask.base_color_texture = checker(model, 0x20ffffffu, 0xff8080ffu, scene::Wrap::Repeat);
    model.textured_quad(model.material(mask), {{{-2, 0, 0}, {0, 0, 0}, {0, 2, 0}, {-2, 2, 0}}}, 3.0f);
    scene::Material veil = test::lamp(2.0f);
    veil.base_color = {0.5f, 0.5f, 0.5f, 0.6f};
    veil.alpha_mode = scene::AlphaMode::Blend;
    model.quad(model.material(veil), {{{0.2f, 0, 0.5f}, {2, 0, 0.5f}, {2, 2, 0.5f}, {0.2f, 2, 0.5f}}});
    model.sky(glm::vec3(0.5f, 0.7f, 1.0f));
}

// Fog, with and without a floor in its boundary; smoke as a volume texture; absorbing glass; an emissive
// medium.
void media(SceneModel& model) {
    model.set_medium(
        {.absorption = glm::vec3(0.02f), .scattering = glm::vec3(0.1f, 0.15f, 0.2f), .anisotropy = 0.5f});
    model.box({}, {-3, 0, -3}, {3, 3, 6});
    CounterRandom random(8);
    std::vector<std::uint32_t> texels;
    for (int i = 0; i < 4 * 3 * 5; ++i) texels.push_back(static_cast<std::uint32_t>(random.below(1u << 24)));
    const scene::TextureSlot smoke = model.texture({.width = 4, .height = 3, .depth = 5}, texels);
    model.set_medium({.absorption = glm::vec3(0.5f),
                      .absorption_texture = smoke,
                      .scattering = glm::vec3(2.0f),
                      .scattering_texture = smoke,
                      .priority = 1});
    model.box({}, {-1.5f, 0.2f, -1}, {0, 1.5f, 0.5f});
    model.set_medium({.emission = {1.0f, 0.5f, 0.2f},
                      .emission_texture = smoke,
                      .absorption = glm::vec3(0.7f),
                      .priority = 1});
    model.box({}, {-0.5f, 1.7f, -0.5f}, {0.5f, 2.2f, 0.5f});
    model.clear_medium();
    scene::Material glass = test::glass(1.4f);
    glass.attenuation_color = {0.4f, 0.8f, 0.9f};
    glass.attenuation_distance = 0.5f;
    model.box(model.material(glass), {0.3f, 0.1f, -0.5f}, {1.4f, 1.2f, 0.4f});
    model.quad(model.material(test::chalk(glm::vec3(0.6f))), Ground);
    model.light({.kind = scene::LightKind::Sphere, .intensity = glm::vec3(20.0f), .radius = 0.2f},
                glm::translate(glm::dmat4(1.0), glm::dvec3(1.5, 2.0, 1.0)));
    model.light({.kind = scene::LightKind::Directional, .intensity = glm::vec3(1.0f)},
                glm::rotate(glm::dmat4(1.0), -1.2, glm::dvec3(1, 0.2, 0)));
    model.sky(glm::vec3(0.3f, 0.4f, 0.5f));
}

struct Case {
    const char* name;
    void (*build)(SceneModel&);
    view::Renderer renderer;
    view::PathClass path_class;
    view::PixelFilterKind filter;
};

// Agreement of two numbers of one sample.
bool agree(float a, float b) {
    return a == b || std::fabs(a - b) <= 1e-3f * (1.0f + std::fabs(a));
}

class TransportOnDevice : public VulkanTest, public testing::WithParamInterface<Case> {
  protected:
    std::vector<float> on_device(const backend::SceneTables& tables, const shading::View& view) {
        const DeviceScene scene(device(), tables);
        const Buffer record = make_buffer(device(), std::vector{scene.record()});
        const Buffer view_record = make_buffer(device(), std::vector{view});
        constexpr std::uint32_t Count = Size * Size * SamplesPerPixel;
        const Buffer results(device(), Count * shading::MaxSampleValues * sizeof(float));
        const ComputePipeline kernel(device(), {.name = "transport",
                                                .code = shaders::transport_comp(),
                                                .constants = {{0, backend::features_for(tables, view)}},
                                                .push_bytes = sizeof(Arguments)});
        run(device(), {.pipeline = &kernel,
                       .arguments = Arguments{record.address(), view_record.address(), results.address()},
                       .groups = {Count / 64},
                       .writes = {&results}});
        return download<float>(device(), results);
    }

  private:
    struct Arguments {
        std::uint64_t scene, view, results;
    };
};

std::vector<float> on_host(const backend::SceneTables& tables, const shading::View& view) {
    const shading::Context context{backend::on_host(tables), view, 0.0f};
    std::vector<float> results;
    for (std::uint32_t i = 0; i < Size * Size * SamplesPerPixel; ++i) {
        const std::uint32_t pixel = i % (Size * Size), index = i / (Size * Size);
        const shading::Path path = shading::trace_sample(context, pixel % Size, pixel / Size, index);
        const shading::SampleValues values = shading::sample_values(view, path.found);
        EXPECT_EQ(values.count, shading::MaxSampleValues);
        results.insert(results.end(), values.items, values.items + values.count);
    }
    return results;
}

TEST_P(TransportOnDevice, MatchesTheHost) {
    SceneModel model;
    GetParam().build(model);
    backend::ShadowScene shadow;
    ASSERT_TRUE(shadow.apply(scene::snapshot(model.finished())));
    backend::MeshCatalog meshes(model.blobs());
    ASSERT_TRUE(meshes.update(shadow.scene(), shadow.take_delta()).problems.empty());
    backend::MipmapCache mipmaps;
    const auto tables =
        backend::make_tables(shadow.scene(), shadow.flat_scene(), meshes, *model.blobs(), mipmaps);
    const glm::dmat4 down = glm::rotate(glm::dmat4(1.0), -0.3, {1.0, 0.0, 0.0});
    view::View view = test::small_view({0.0, 2.5, 5.0}, 0.9, Size, down);
    view.max_bounces = 8;
    view.channels = AllChannels;
    view.renderer = GetParam().renderer;
    view.path_class = GetParam().path_class;
    view.pixel_filter = {GetParam().filter, 1.5f};
    shading::View record = backend::make_view(view, tables.render_origin);
    record.containing_media = backend::media_around(tables, record);

    const std::vector<float> host = on_host(tables, record), device = on_device(tables, record);
    ASSERT_EQ(host.size(), device.size());
    constexpr std::size_t Count = Size * Size * SamplesPerPixel;
    std::size_t other = 0, lit = 0;
    for (std::size_t i = 0; i < Count; ++i) {
        const auto first = static_cast<std::ptrdiff_t>(i * shading::MaxSampleValues);
        const auto last = first + shading::MaxSampleValues;
        other += std::equal(host.begin() + first, host.begin() + last, device.begin() + first, agree) ? 0 : 1;
        lit += host[static_cast<std::size_t>(first)] > 0.0f ? 1 : 0;
    }
    std::printf("%zu of %zu samples differ by more than 1e-3\n", other, Count);
    EXPECT_GT(lit, Count / 3);
    EXPECT_LE(other, Count / 200);
}

INSTANTIATE_TEST_SUITE_P(Scenes, TransportOnDevice,
                         testing::Values(Case{"lights", lights_and_textures, view::Renderer::PathTracing,
                                              view::PathClass::Indirect, view::PixelFilterKind::Box},
                                         Case{"lights_whitted", lights_and_textures, view::Renderer::Whitted,
                                              view::PathClass::Diffuse, view::PixelFilterKind::Box},
                                         Case{"sizes", lights_with_sizes, view::Renderer::PathTracing,
                                              view::PathClass::Indirect, view::PixelFilterKind::Box},
                                         Case{"catcher", caught_shadows, view::Renderer::PathTracing,
                                              view::PathClass::Indirect, view::PixelFilterKind::Box},
                                         Case{"speculars", speculars_and_sky, view::Renderer::PathTracing,
                                              view::PathClass::Caustics, view::PixelFilterKind::Gaussian},
                                         Case{"speculars_whitted", speculars_and_sky, view::Renderer::Whitted,
                                              view::PathClass::None, view::PixelFilterKind::BlackmanHarris},
                                         Case{"alpha", alpha_and_colors, view::Renderer::PathTracing,
                                              view::PathClass::Diffuse, view::PixelFilterKind::Box},
                                         Case{"media", media, view::Renderer::PathTracing,
                                              view::PathClass::Indirect, view::PixelFilterKind::Box},
                                         Case{"media_whitted", media, view::Renderer::Whitted,
                                              view::PathClass::All, view::PixelFilterKind::Box}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace tessera::vulkan
