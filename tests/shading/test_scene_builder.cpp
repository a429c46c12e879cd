#include "tests/shading/test_scene_builder.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <numeric>
#include <stdexcept>
#include <string>

#include "mediator/backend/tables/light_tree.h"
#include "mediator/backend/tables/tables.h"
#include "mediator/shading/sampling.h"
#include "mediator/shading/scaling.h"
#include "tests/shading/generator.h"
#include "tests/shading/test_materials.h"

namespace tessera::shading {

namespace {

constexpr uint Vertices = 12, Triangles = 10, Instances = TestMaterials, FirstHard = 4;

class Packer {
  public:
    explicit Packer(std::uint64_t address) : address_(address) {}

    // Appends an array; returns its final address.
    template <class Array, class Item>
    Array add(const std::vector<Item>& items) {
        static_assert(sizeof(Array) == sizeof(std::uint64_t));
        bytes_.resize((bytes_.size() + 15) / 16 * 16);
        const std::size_t offset = bytes_.size();
        bytes_.resize(offset + items.size() * sizeof(Item));
        std::memcpy(bytes_.data() + offset, items.data(), items.size() * sizeof(Item));
        return std::bit_cast<Array>(address_ + offset);
    }
    std::vector<std::byte> take() { return std::move(bytes_); }

  private:
    std::uint64_t address_;
    std::vector<std::byte> bytes_;
};

// Cumulative sums that end at 1; some steps are 0.
void add_sums(std::vector<float>& sums, uint count, Generator& random) {
    std::vector<double> steps;
    double total = 0.0;
    for (uint i = 0; i < count; ++i) {
        steps.push_back(i > 0 && random.bits() % 5u == 0u ? 0.0 : double(random.between(0.1f, 1.0f)));
        total += steps.back();
    }
    double sum = 0.0;
    for (const double step : steps) sums.push_back(float((sum += step) / total));
    sums.back() = 1.0f;
}

std::vector<Texture> make_textures(Packer& packer, Generator& random) {
    std::vector<Texture> textures;
    for (uint i = 0; i < TextureCount; ++i) {
        Texture texture{.width = 1u + i % 5u * 3u,
                        .height = 1u + i % 3u * 2u,
                        .format = i % 3u,
                        .wrap_s = i % 3u,
                        .wrap_t = (i / 2u) % 3u,
                        .texture_filter = i == 5u ? TextureNearest : TextureLinear,
                        .depth = 1u};
        const bool floats = texture.format == TexelRgbFloat;
        std::vector<uint> words;
        for (uint word = 0; word < texture.width * texture.height * (floats ? 3u : 1u); ++word) {
            words.push_back(floats ? float_bits(random.between(0.0f, 4.0f)) : random.bits());
        }
        texture.texels = packer.add<UintArray>(words);
        if (!floats && texture.texture_filter == TextureLinear) {
            words.clear();
            for (uint width = texture.width, height = texture.height; width > 1u || height > 1u;
                 ++texture.level_count) {
                width = std::max(width / 2u, 1u);
                height = std::max(height / 2u, 1u);
                for (uint texel = 0; texel < width * height; ++texel) words.push_back(hash_u32(texel));
            }
            if (!words.empty()) texture.levels = packer.add<UintArray>(words);
        }
        textures.push_back(texture);
    }
    return textures;
}

Mesh make_mesh(uint number, Packer& packer, Generator& random) {
    const bool hard = number % 2u == 1u;
    std::vector<vec3> positions, normals;
    std::vector<vec4> tangents, colors;
    std::vector<vec2> tex_coords, tex_coords_1;
    for (uint i = 0; i < Vertices; ++i) {
        positions.emplace_back(random.between(-1.0f, 1.0f), random.between(-1.0f, 1.0f),
                               random.between(-1.0f, 1.0f));
        normals.push_back(random.anywhere());
        tangents.emplace_back(random.anywhere(), random.either_sign(1.0f));
        colors.emplace_back(random.color(), random.between(0.2f, 1.0f));
        tex_coords.emplace_back(random.between(-1.0f, 2.0f), random.between(-1.0f, 2.0f));
        tex_coords_1.emplace_back(random.between(-1.0f, 2.0f), random.between(-1.0f, 2.0f));
    }
    std::vector<uvec3> triangles;
    for (uint i = 0; i < Triangles; ++i) triangles.emplace_back(i, i + 1, i + 2);
    if (hard) {
        positions[2] = positions[1] + vec3(1e-6f, 0.0f, 0.0f);  // a thin triangle
        positions[5] = positions[4];                            // no area
        positions[8] = positions[7] * 1e-20f;
        triangles[9] = uvec3(3u, 3u, 3u);
    }
    Mesh mesh{.positions = packer.add<Vec3Array>(positions),
              .triangles = packer.add<UVec3Array>(triangles),
              .normals = packer.add<Vec3Array>(normals),
              .tangents = packer.add<Vec4Array>(tangents),
              .colors = packer.add<Vec4Array>(colors),
              .tex_coords = packer.add<Vec2Array>(tex_coords),
              .tex_coords_1 = packer.add<Vec2Array>(tex_coords_1),
              .arrays = MeshNormals | MeshTangents | MeshColors | MeshTexCoords | MeshTexCoords1,
              .triangle_count = Triangles};
    if (number == 2u) mesh.arrays = MeshTexCoords;
    if (number == 3u) mesh.arrays = 0u;
    return mesh;
}

// Meshes 0 and 2 for the first instances, 1 and 3 for the edge cases.
std::vector<Instance> make_instances(Generator& random) {
    std::vector<Instance> instances;
    for (uint i = 0; i < Instances; ++i) {
        const float size = i == 4 ? 1e-8f : i == 5 ? 1e7f : 1.0f;
        const mat3 turn = frame_around(random.anywhere());
        const mat3 linear(turn[0] * (size * random.between(0.5f, 2.0f)),
                          turn[1] * (size * random.either_sign(random.between(0.5f, 2.0f))), turn[2] * size);
        mat3 normals(cross(linear[1], linear[2]), cross(linear[2], linear[0]), cross(linear[0], linear[1]));
        const float scale = unit_scale(largest(max(max(abs(normals[0]), abs(normals[1])), abs(normals[2]))));
        normals = mat3(normals[0] * scale, normals[1] * scale, normals[2] * scale);
        instances.push_back({.mesh = i % 2u * 2u + (i < FirstHard ? 0u : 1u),
                             .material = i,
                             .object = 100u + i,
                             .light = i == 2   ? 0
                                      : i == 6 ? 1
                                               : -1,
                             .linear = linear,
                             .translation = size * vec3(1.0f, -2.0f, 3.0f),
                             .normals = normals,
                             .alpha_tested = i % 2u,
                             .motion = -1,
                             .medium = i == 7u ? -1 : int(i % MediumCount),
                             .handedness = i % 3u == 1u ? -1.0f : 1.0f});
    }
    return instances;
}

// Homogeneous and textured, with and without a surface.
std::vector<Medium> make_media(Generator& random) {
    std::vector<Medium> media;
    for (uint i = 0; i < MediumCount; ++i) {
        media.push_back(
            {.absorption = random.color(),
             .priority = int(i % 3u),
             .scattering = i != 2u ? random.color() : vec3(0.0f),
             .anisotropy = random.between(-0.9f, 0.9f),
             .emission = i != 1u ? random.color() : vec3(0.0f),
             .index_matched = i % 2u,
             .low = vec3(-1.0f),
             .textured = i < 2u ? 1u : 0u,
             .inverse_size = vec3(0.5f),
             .index = i == 0u   ? -1.0f
                      : i == 3u ? 0.0f
                                : random.between(1.0f, 2.0f),
             .textures = {texture_use(i < 2u ? 1 : -1, random), texture_use(i == 1u ? 4 : -1, random),
                          texture_use(i == 0u ? 2 : -1, random)}});
    }
    return media;
}

constexpr uint Emitters = TriangleEmitters + 4u;
static_assert(TriangleEmitters == 2u * Triangles);

// Those in the tree, then two distant ones.
std::vector<LightSource> make_lights(Generator& random) {
    constexpr uint Kinds[LightCount] = {LightMesh,   LightMesh, LightPoint,       LightSpot,
                                        LightSphere, LightQuad, LightDirectional, LightEnvironment};
    std::vector<LightSource> lights;
    for (uint i = 0; i < LightCount; ++i) {
        const mat3 frame = frame_around(random.anywhere());
        lights.push_back({.kind = Kinds[i],
                          .irradiance = 0.1f + 0.1f * float(i % 2u),
                          .intensity = vec3(3.0f, 2.0f, 1.0f) * random.between(0.5f, 2.0f),
                          .position = 3.0f * random.anywhere(),
                          .direction = frame[2],
                          .cos_inner = 0.6f,
                          .cos_outer = -0.3f,
                          .radius = random.between(0.3f, 3.0f),
                          .one_minus_cos_half_angle = random.between(0.01f, 0.5f),
                          .edge_u = frame[0],
                          .edge_v = frame[1],
                          .half_size = vec2(random.between(0.3f, 3.0f), 1.0f),
                          .instance = i == 1u ? 6u : 2u,
                          .first_emitter = i < 2u ? i * Triangles : 2u * Triangles + i - 2u});
    }
    return lights;
}

std::vector<Emitter> make_emitters() {
    std::vector<Emitter> emitters;
    for (uint i = 0; i < Emitters; ++i) {
        const bool is_triangle = i < 2u * Triangles;
        emitters.push_back({.light = is_triangle ? i / Triangles : 2u + i - 2u * Triangles,
                            .triangle = is_triangle ? i % Triangles : 0u,
                            .node = NoLightNode,
                            .inverse_root_area = 0.6f});
    }
    return emitters;
}

// Nodes of all kinds, with arbitrary bounds. The point light is not in the tree.
std::vector<LightNode> make_nodes(std::vector<Emitter>& emitters, Generator& random) {
    std::vector<backend::LightLeaf> leaves;
    for (uint i = 0; i < Emitters; ++i) {
        const vec3 low = 2.0f * random.anywhere();
        if (i == TriangleEmitters) continue;
        leaves.push_back({.low = low,
                          .high = low + random.color() * (i % 4u == 0u ? 0.0f : 1.0f),
                          .axis = random.anywhere(),
                          .spread = i % 3u == 0u ? double(Pi) : double(random.between(0.0f, 1.0f)),
                          .emission_angle = double(random.between(0.3f, 1.6f)),
                          .power = double(random.between(0.1f, 10.0f)),
                          .emitter = i,
                          .is_area = i >= TriangleEmitters,
                          .two_sided = i % 2u == 0u});
    }
    std::vector<LightNode> nodes = backend::make_light_tree(leaves, emitters);
    if (nodes.size() != LightNodes)
        throw std::logic_error("there are " + std::to_string(nodes.size()) + " nodes");
    return nodes;
}

// Two cells; some faces have a split, or no cell.
std::vector<SkyNode> make_sky_nodes() {
    const SkyNode first{0.0f, SkyLeaf, 0u}, second{0.0f, SkyLeaf, 1u}, none{0.0f, SkyLeaf, NoSkyCell};
    return {{0.1f, 0u, 7u}, first, second, none, {-0.2f, 1u, 9u}, first, second, first, second, none, second};
}

std::vector<SkyCell> make_sky_cells() {
    return {{0u, 0.4f, 0.5f, 0.2f}, {SkyTiles, 1.0f, 0.1f, 0.9f}};
}

std::vector<float> make_sky_cdfs(Generator& random) {
    std::vector<float> cdfs;
    for (uint cell = 0; cell < 2u; ++cell) {
        std::vector<float> weights;
        for (uint tile = 0; tile < SkyTiles; ++tile) weights.push_back(random.between(0.0f, 1.0f));
        float sum = 0.0f;
        const float all = std::accumulate(weights.begin(), weights.end(), 0.0f);
        for (const float weight : weights) cdfs.push_back(std::min((sum += weight) / all, 1.0f));
        cdfs.back() = 1.0f;
    }
    return cdfs;
}

std::vector<View> make_views(Generator& random) {
    std::vector<View> views;
    for (uint i = 0; i < ViewCount; ++i) {
        const mat3 turn = frame_around(random.anywhere());
        views.push_back(
            {.seed = (std::uint64_t{random.bits()} << 32) | random.bits(),
             .eye = random.anywhere(),
             .right = turn[0],
             .up = turn[1],
             .forward = turn[2],
             .image_center = {random.between(-0.1f, 0.1f), random.between(-0.1f, 0.1f)},
             .step = {0.02f, -0.02f},
             .width = 64,
             .height = 48,
             .pixel_filter = i % 3u,
             .filter_radius = i % 3u == FilterBox ? 0.5f : 1.5f,
             .max_scatter_events = i % 4u == 0u ? UnlimitedScatterEvents : i % 4u,
             .renderer = i % 5u == 0u ? RendererWhitted : RendererPathTracing,
             .path_class = i % 5u,
             .feature_rule = i % 2u,
             .channels = i == 0u ? 0xfffu : random.bits() & 0xfffu,
             .recorded_quantities = random.bits() & (RecordsDiffuse | RecordsConnections | RecordsHeadlight),
             .transparent_background = i % 2u,
             .strategy = i % 6u == 4u ? StrategyLightsOnly : StrategyBoth,
             .camera = i % 8u,
             .lens_radius = 0.1f,
             .focus_distance = 2.0f,
             .containing_media = no_media(),
             .max_specular_events = 1u + i % 3u,
             .clamp_indirect = i % 7u == 3u ? 0.5f : 0.0f,
             .sky_cells_from = i % 2u == 0u ? NoSkyCells : 0u});
    }
    return views;
}

std::vector<View> with_sky_cells(std::vector<View> views, Packer& packer) {
    Generator random(false);
    const auto nodes = packer.add<SkyNodeArray>(make_sky_nodes());
    const auto cells = packer.add<SkyCellArray>(make_sky_cells());
    const auto cdfs = packer.add<FloatArray>(make_sky_cdfs(random));
    for (View& view : views) {
        view.sky_nodes = nodes;
        view.sky_cells = cells;
        view.sky_cdfs = cdfs;
    }
    return views;
}

Scene without_lights(Scene scene) {
    scene.light_count = 0;
    scene.tree_light_count = 0;
    scene.features = 0;
    scene.environment.visible_color = vec4(0.4f, 0.3f, 0.2f, 0.7f);
    scene.environment.shows_color = 1u;
    scene.environment_light = -1;
    return scene;
}

}  // namespace

PackedTestScene make_test_scene(std::uint64_t address) {
    Packer packer(address);
    Generator random(false);
    const std::vector<Texture> textures = make_textures(packer, random);
    std::vector<float> sums;
    Scene scene{.instance_count = Instances,
                .light_count = LightCount,
                .tree_light_count = TreeLightCount,
                .tree_intensity = 0.4f,
                .features = 0xf0ffu | FeatureLightTree | FeatureAreaLights | FeatureSunDisks |
                            FeatureShadowCatcher | FeatureSurfaceShader | FeatureIridescence,
                .tree_scale = 0.25f};
    // The bounds of the functions' deviations were measured with the values that follow these.
    std::vector<float> unused;
    add_sums(unused, LightCount - TreeLightCount + 1u, random);
    scene.environment = {.map = textures[2],
                         .color = vec3(0.1f, 0.2f, 0.3f),
                         .strength = 0.8f,
                         .rotation = 0.7f,
                         .row_cdf = uint(sums.size()),
                         .emits = 1u};
    scene.environment.map.wrap_s = WrapRepeat;
    scene.environment.map.wrap_t = WrapClamp;
    const uint width = scene.environment.map.width, height = scene.environment.map.height;
    add_sums(sums, height, random);
    scene.environment.column_cdf = uint(sums.size());
    for (uint row = 0; row < height; ++row) add_sums(sums, width, random);
    scene.environment_light = 7;

    scene.textures = packer.add<TextureArray>(textures);
    scene.materials = packer.add<MaterialArray>(make_test_materials(random));
    scene.extras = packer.add<MaterialExtrasArray>(make_test_extras(random));
    Generator shader_random(false);  // separate, so that all other values stay the same
    scene.surface_shaders = packer.add<SurfaceShaderParamsArray>(make_test_shaders(shader_random));
    std::vector<Mesh> meshes;
    for (uint i = 0; i < 4; ++i) meshes.push_back(make_mesh(i, packer, random));
    scene.meshes = packer.add<MeshArray>(meshes);
    std::vector<MeshKey> steps;
    for (const Mesh& mesh : meshes) steps.push_back({mesh.positions, mesh.normals});
    scene.mesh_keys = packer.add<MeshKeyArray>(steps);
    const std::vector<Instance> instances = make_instances(random);
    std::vector<Affine3x4> places;
    for (const Instance& instance : instances) places.push_back({instance.linear, instance.translation});
    scene.transform_keys = packer.add<Affine3x4Array>(places);
    scene.motions = packer.add<MotionArray>(std::vector<Motion>{{.first_key = 0,
                                                                 .key_intervals = 3,
                                                                 .max_abs_linear = 2.0f,
                                                                 .max_abs_translation = glm::vec3(4.0f)}});
    scene.instances = packer.add<InstanceArray>(instances);
    Generator media_random(false);
    scene.media = packer.add<MediumArray>(make_media(media_random));
    scene.lights = packer.add<LightSourceArray>(make_lights(random));
    std::vector<Emitter> emitters = make_emitters();
    scene.light_nodes = packer.add<LightNodeArray>(make_nodes(emitters, random));
    scene.emitters = packer.add<EmitterArray>(emitters);
    scene.cdfs = packer.add<FloatArray>(sums);
    const std::span<const float> srgb = backend::srgb_values();
    scene.srgb = packer.add<FloatArray>(std::vector<float>(srgb.begin(), srgb.end()));
    const std::span<const float> energy = backend::energy_values();
    scene.energy = packer.add<FloatArray>(std::vector<float>(energy.begin(), energy.end()));

    TestScene test_scene{};
    test_scene.scenes = packer.add<SceneArray>(std::vector<Scene>{scene, without_lights(scene)});
    test_scene.views = packer.add<ViewArray>(with_sky_cells(make_views(random), packer));
    return {packer.take(), test_scene};
}

}  // namespace tessera::shading
