// The tables of a scene, which are the same for all back-ends.
#include "mediator/backend/tables/tables.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <set>

#include "mediator/shading/surfaces.h"
#include "tests/backend/tables_fixture.h"

namespace tessera::backend {
namespace {

using scene::Create;
using test::moved;
using test::SceneBuilder;
using test::transform;

constexpr ObjectId Corner{2}, PaintId{3}, Place{4}, Picture{5}, Sun{6}, Sky{7}, Bulb{8}, Emissive{9},
    Panel{10};

struct Stage : test::TablesFixture {
    MeshCatalog::Result steps;

    // Two triangles of the areas 1/2 and 3/2 times the size squared, facing +z.
    scene::Geometry corner(ObjectId material, float size = 1.0f) {
        return {.material = material,
                .indices = blob(std::array{0u, 1u, 2u, 0u, 2u, 3u}),
                .positions = blob(
                    std::array<glm::vec3, 4>{{{0, 0, 0}, {size, 0, 0}, {size, size, 0}, {0, 3 * size, 0}}})};
    }
    SceneTables make(std::vector<scene::Entry> entries) {
        EXPECT_TRUE(shadow.apply(builder.edit(std::move(entries))));
        steps = meshes.update(shadow.scene(), shadow.take_delta());
        return make_all();
    }
};

TEST(Tables, HaveAnInstanceForEachPlacedGeometry) {
    Stage stage;
    const SceneTables tables = stage.make(
        {Create{scene::RootId, scene::Root{.children = {Corner, Place}, .render_origin = {1000.0, 0.0, 0.0}}},
         Create{Corner, stage.corner(PaintId)},
         Create{Place, transform(moved(1001.0, 2.0, 3.0), {Corner, Panel})},
         Create{PaintId, scene::Material{.roughness = 0.25f, .double_sided = true}},
         Create{Panel, stage.corner(ObjectId{99})}});
    ASSERT_EQ(tables.instances.size(), 3u);
    ASSERT_EQ(tables.meshes.size(), 2u) << "shared by both instances";
    ASSERT_EQ(tables.materials.size(), 3u) << "the default, the placeholder's and this";
    EXPECT_EQ(tables.instances[0].mesh, tables.instances[1].mesh);
    EXPECT_EQ(tables.instances[0].translation, glm::vec3(-1000.0f, 0.0f, 0.0f));
    EXPECT_EQ(tables.instances[1].translation, glm::vec3(1.0f, 2.0f, 3.0f));
    EXPECT_EQ(tables.instances[1].object, Corner.value);
    EXPECT_EQ(tables.materials[tables.instances[1].material].roughness, 0.25f);
    EXPECT_EQ(tables.materials[tables.instances[1].material].double_sided, 1u);
    EXPECT_EQ(tables.instances[2].material, 0u) << "the default grey";
    EXPECT_EQ(tables.scene.features, 0u);
    const shading::Scene scene = on_host(tables);
    EXPECT_EQ(scene.instance_count, 3u);
    const shading::Mesh& mesh = scene.meshes.items[scene.instances.items[2].mesh];
    EXPECT_EQ(mesh.triangle_count, 2u);
    EXPECT_EQ(mesh.arrays, 0u);
    EXPECT_EQ(mesh.positions.items[mesh.triangles.items[1].z], glm::vec3(0.0f, 3.0f, 0.0f));
}

// Transformed normals keep their direction and side at any scale, and in mirrored instances.
TEST(Tables, NormalsSurviveTinyHugeAndMirroredInstances) {
    for (const double scale : {1.0, 1e-25, 1e25, -1e-3}) {
        Stage stage;
        const glm::dmat4 matrix = glm::scale(glm::dmat4(1.0), glm::dvec3(scale, 2.0 * scale, scale));
        const SceneTables tables =
            stage.make({Create{scene::RootId, scene::Root{.children = {Place}}},
                        Create{Place, transform(matrix, {Corner})}, Create{Corner, stage.corner(PaintId)}});
        const glm::vec3 normal = tables.instances.at(0).normals * glm::vec3(0.0f, 0.0f, 1.0f);
        const float length = glm::length(normal);
        EXPECT_TRUE(length > 1e-3f && length < 1e3f) << scale;
        EXPECT_EQ(normal, glm::vec3(0.0f, 0.0f, scale < 0.0 ? -length : length)) << scale;
    }
}

TEST(Tables, TheTreeAndInfiniteLightsAreWeighedByIrradiance) {
    Stage stage;
    const scene::Material emissive{.emission = glm::vec3(2.0f)};
    const SceneTables tables = stage.make(
        {Create{scene::RootId, scene::Root{.children = {Corner, Bulb, Panel, Sun}, .background = Sky}},
         Create{Corner, stage.corner(Emissive, 2.0f)}, Create{Panel, stage.corner(PaintId)},
         Create{PaintId, scene::Material{}}, Create{Emissive, emissive},
         Create{Bulb, scene::Light{.intensity = glm::vec3(3.0f)}},
         Create{Sun, scene::Light{.kind = scene::LightKind::Directional, .intensity = glm::vec3(0.2f)}},
         Create{Sky, scene::Background{.color = glm::vec3(0.5f)}}});
    ASSERT_EQ(tables.lights.size(), 4u);
    EXPECT_EQ(tables.scene.tree_light_count, 2u);
    const shading::LightSource &mesh = tables.lights[0], &bulb = tables.lights[1];
    EXPECT_EQ(mesh.kind, shading::LightMesh);
    EXPECT_EQ(bulb.kind, shading::LightPoint);
    EXPECT_EQ(tables.lights[2].kind, shading::LightDirectional);
    EXPECT_EQ(tables.instances[0].light, 0);
    EXPECT_EQ(tables.instances[1].light, -1);
    ASSERT_EQ(tables.scene.environment_light, 3);
    EXPECT_EQ(tables.lights[3].irradiance, 0.0f)
        << "an even sky is found by BSDF samples, but where cells know its visible parts";
    EXPECT_EQ(tables.scene.environment.emits, 1u);
    // All of the mesh faces one way: its radiance of 2 times its area of 8.
    const double scale = tables.scene.tree_scale, tree = (2.0 * 8.0 + 3.0) * scale * scale;
    EXPECT_NEAR(tables.scene.tree_intensity, tree / (tree + 0.2), 1e-6);
    EXPECT_NEAR(tables.lights[2].irradiance, 0.2 / (tree + 0.2), 1e-6);
    EXPECT_EQ(tables.scene.features, shading::FeatureMeshLights | shading::FeaturePunctualLights |
                                         shading::FeatureEnvironment | shading::FeatureLightTree);
}

TEST(Tables, EachEmissiveTriangleIsAnEmitterOfItsPower) {
    Stage stage;
    const std::array<glm::vec3, 6> texels{{{4, 4, 4}, {4, 4, 4}, {4, 4, 4}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}}};
    scene::Geometry painted = stage.corner(Emissive);
    painted.indices = stage.blob(std::array{0u, 1u, 2u, 0u, 2u, 3u, 0u, 0u, 1u});
    // The texture's bright half.
    painted.tex_coords =
        stage.blob(std::array<glm::vec2, 4>{{{0.0f, 0.1f}, {1.0f, 0.1f}, {0.5f, 0.1f}, {0.5f, 0.1f}}});
    const SceneTables tables =
        stage.make({Create{scene::RootId, scene::Root{.children = {Corner, Bulb}}}, Create{Corner, painted},
                    Create{Bulb, scene::Light{.intensity = glm::vec3(1.0f)}},
                    Create{Emissive, scene::Material{.emission = glm::vec3(2.0f),
                                                     .emission_texture = {.texture = Picture},
                                                     .double_sided = true}},
                    Create{Picture, scene::Texture{.width = 3,
                                                   .height = 2,
                                                   .format = scene::TexelFormat::RgbFloat,
                                                   .wrap_t = scene::Wrap::Clamp,
                                                   .texels = stage.blob(texels)}}});
    ASSERT_EQ(tables.emitters.size(), 4u);
    EXPECT_EQ(tables.lights[1].first_emitter, 3u);
    EXPECT_FLOAT_EQ(tables.emitters[0].inverse_root_area, std::sqrt(2.0f));
    EXPECT_FLOAT_EQ(tables.emitters[1].inverse_root_area, 1.0f / std::sqrt(1.5f));
    EXPECT_EQ(tables.emitters[1].triangle, 1u);
    EXPECT_EQ(tables.emitters[2].node, shading::NoLightNode) << "it has no area";
    ASSERT_EQ(tables.light_nodes.size(), 4u) << "the root and three leaves";
    const auto power = [&](std::size_t i) {
        return double(tables.light_nodes.at(tables.emitters[i].node).power);
    };
    EXPECT_NEAR(power(0) / power(3), 0.5 * 8.0 * 2.0 * M_PI / (4.0 * M_PI), 1e-3);
    EXPECT_NEAR(power(1) / power(3), 1.5 * 8.0 * 2.0 * M_PI / (4.0 * M_PI), 1e-3);
    EXPECT_NEAR(power(0) + power(1) + power(3), 1.0, 1e-6);
}

// The grid of samples misses the texture's brightest texel, but the triangle keeps some power.
TEST(Tables, ATriangleWithAMissedBrightTexelIsStillSampled) {
    for (const float brightest : {0.0f, 100.0f}) {
        Stage stage;
        std::vector<glm::vec3> texels(64 * 64, glm::vec3(0.0f));
        texels[3] = glm::vec3(brightest);
        scene::Geometry painted = stage.corner(Emissive);
        painted.tex_coords =
            stage.blob(std::array<glm::vec2, 4>{{{0.5f, 0.5f}, {0.6f, 0.5f}, {0.6f, 0.6f}, {0.5f, 0.6f}}});
        scene::Texture map{.width = 64, .height = 64, .format = scene::TexelFormat::RgbFloat};
        map.texels = scene::reference(*stage.blobs->insert(std::as_bytes(std::span(texels))));
        const SceneTables tables =
            stage.make({Create{scene::RootId, scene::Root{.children = {Corner}}}, Create{Corner, painted},
                        Create{Emissive, scene::Material{.emission = glm::vec3(1.0f),
                                                         .emission_texture = {.texture = Picture}}},
                        Create{Picture, map}});
        EXPECT_EQ(tables.light_nodes.size(), brightest > 0.0f ? 3u : 0u);
        EXPECT_EQ(tables.lights.size(), brightest > 0.0f ? 1u : 0u);
    }
}

// A checker of single texels: a point lookup gives one of them, a wide footprint their mean.
TEST(Tables, TexturesAreFilteredByTheFootprint) {
    Stage stage;
    std::vector<std::uint8_t> texels;
    for (std::uint32_t i = 0; i < 64 * 64; ++i)
        texels.insert(texels.end(), 4, (i + i / 64) % 2 == 0 ? std::uint8_t{255} : std::uint8_t{0});
    scene::Geometry painted = stage.corner(PaintId);
    painted.tex_coords = stage.blob(std::array<glm::vec2, 4>{{{0, 0}, {1, 0}, {1, 1}, {0, 3}}});
    scene::Texture map{.width = 64, .height = 64};
    map.texels = scene::reference(*stage.blobs->insert(std::as_bytes(std::span(texels))));
    const SceneTables tables =
        stage.make({Create{scene::RootId, scene::Root{.children = {Corner}}}, Create{Corner, painted},
                    Create{PaintId, scene::Material{.base_color = glm::vec4(1.0f),
                                                    .base_color_texture = {.texture = Picture}}},
                    Create{Picture, map}});
    EXPECT_EQ(tables.textures.at(0).level_count, 6u);
    const shading::Scene scene = on_host(tables);
    // At the center of a texel of the first triangle.
    const auto seen = [&](float width) {
        const shading::Hit hit{
            .instance = 0, .triangle = 0, .barycentric = {8.0f / 64, 8.5f / 64}, .distance = 1.0f};
        return shading::make_surface(scene, hit, {0.0f, 0.0f, -1.0f}, width, shading::no_media(), 0.0f)
            .albedo.x;
    };
    const float point = seen(0.0f);
    EXPECT_TRUE(std::abs(point - 0.5f) > 0.49f) << point;
    EXPECT_EQ(seen(0.9f / 64), point) << "no wider than a texel: the same bits";
    EXPECT_NEAR(seen(2.0f / 64), 0.5f, 0.003f);
    EXPECT_NEAR(seen(1e6f), 0.5f, 0.003f);
    const float between = std::abs(seen(1.4f / 64) - 0.5f);
    EXPECT_TRUE(between > 0.1f && between < 0.4f) << between;
}

// Textures of an unused material, without users, and of a material that an edit adds.
TEST(Tables, HaveOnlyTexturesInUse) {
    Stage stage;
    const auto map = [&](std::uint8_t value) {
        scene::Texture texture{.width = 2, .height = 1};
        texture.texels = stage.blob(std::array<std::uint8_t, 8>{value, 0, 0, 0, 0, 0, 0, 0});
        return texture;
    };
    constexpr ObjectId Unused{20}, Unseen{21}, Shine{22}, Coat{23};
    const auto only = [](const SceneTables& tables) {
        std::set<std::uint8_t> first;
        for (const scene::BlobPtr& texels : tables.texels) first.insert(texels->as<std::uint8_t>()[0]);
        return first;
    };
    SceneTables tables = stage.make(
        {Create{scene::RootId, scene::Root{.children = {Corner, Panel}, .background = Sky}},
         Create{Sky, scene::Background{.environment = Bulb}}, Create{Bulb, map(1)}, Create{Picture, map(2)},
         Create{Unused, map(3)}, Create{Unseen, map(4)}, Create{Shine, map(5)}, Create{Coat, map(6)},
         Create{Corner, stage.corner(PaintId)}, Create{Panel, stage.corner(Emissive)},
         Create{PaintId, scene::Material{.emission_texture = {.texture = Shine},
                                         .clearcoat = 1.0f,
                                         .clearcoat_roughness_texture = {.texture = Coat}}},
         Create{Emissive, scene::SurfaceShader{.ambient_texture = {.texture = Unused},
                                               .diffuse_texture = {.texture = Picture}}},
         Create{Sun, scene::Material{.base_color_texture = {.texture = Unseen}}}});
    EXPECT_EQ(only(tables), (std::set<std::uint8_t>{1, 2, 5, 6}));
    for (std::size_t i = 0; i < tables.textures.size(); ++i) {
        const std::uint8_t first = tables.texels[i]->as<std::uint8_t>()[0];
        EXPECT_EQ(tables.levels[i] != nullptr, first == 2 || first == 6) << "not of light: " << int{first};
    }
    tables = stage.make(
        {SceneBuilder::update<scene::Geometry>(Corner, &scene::Geometry::material, {.material = Sun})});
    EXPECT_EQ(only(tables), (std::set<std::uint8_t>{1, 2, 4}));
}

TEST(Tables, LayersAndViewsWithHiddenLayersSetTheFeature) {
    Stage stage;
    scene::Transform place = transform(moved(0.0, 0.0, 0.0), {Corner, Bulb});
    place.layers = 6;
    const SceneTables tables = stage.make(
        {Create{scene::RootId, scene::Root{.children = {Panel, Place}, .background = Sky}},
         Create{Place, place}, Create{Corner, stage.corner(Emissive)}, Create{Panel, stage.corner(PaintId)},
         Create{Bulb, scene::Light{}}, Create{PaintId, scene::Material{}},
         Create{Emissive, scene::Material{.emission = glm::vec3(2.0f)}},
         Create{Sky, scene::Background{.color = glm::vec3(0.5f)}}});
    ASSERT_EQ(tables.lights.size(), 3u) << "panel, bulb and sky";
    EXPECT_EQ(tables.instances.at(0).layers, 6u);
    EXPECT_EQ(tables.instances.at(1).layers, 1u);
    EXPECT_EQ(tables.lights[0].layers, 6u) << "the emissive panel";
    EXPECT_EQ(tables.lights[1].layers, 6u) << "the bulb";
    for (const std::uint32_t sees_all : {shading::AllLayers, 3u, 5u}) {
        EXPECT_EQ(features_for(tables, shading::View{.layers = sees_all}), tables.scene.features);
    }
    for (const std::uint32_t hides : {0u, 1u, 4u, 8u}) {
        EXPECT_EQ(features_for(tables, shading::View{.layers = hides}),
                  tables.scene.features | shading::FeatureLayers)
            << hides;
    }
}

TEST(Tables, ADegenerateLampAndABlackSkyAreNoLights) {
    Stage stage;
    const glm::dmat4 flat = glm::scale(glm::dmat4(1.0), glm::dvec3(0.0));
    const SceneTables tables = stage.make(
        {Create{scene::RootId, scene::Root{.children = {Place}, .background = Sky}},
         Create{Place, transform(flat, {Corner, Sun})}, Create{Corner, stage.corner(Emissive)},
         Create{Emissive, scene::Material{.emission = glm::vec3(2.0f)}},
         Create{Sun, scene::Light{.kind = scene::LightKind::Directional}}, Create{Sky, scene::Background{}}});
    EXPECT_TRUE(tables.lights.empty());
    EXPECT_EQ(tables.scene.light_count, 0u);
    EXPECT_EQ(tables.scene.environment_light, -1);
    EXPECT_EQ(tables.instances.at(0).light, -1);
    EXPECT_EQ(tables.scene.environment.emits, 0u);
}

std::vector<scene::Entry> sky_with_a_map(Stage& stage) {
    const std::array<glm::vec3, 2> texels{{{1, 1, 1}, {3, 3, 3}}};
    return {Create{scene::RootId, scene::Root{.children = {Corner}, .background = Sky}},
            Create{Corner, stage.corner(PaintId)},
            Create{PaintId, scene::Material{.base_color_texture = {.texture = Picture}}},
            Create{Picture, scene::Texture{.width = 2,
                                           .height = 1,
                                           .format = scene::TexelFormat::RgbFloat,
                                           .wrap_t = scene::Wrap::Mirror,
                                           .texels = stage.blob(texels)}},
            Create{Sky, scene::Background{.color = glm::vec3(1.0f), .environment = Picture}}};
}

// Half of a texel's weight is its own luminance, half that of its neighbourhood.
TEST(Tables, EnvironmentWeightsAreTheExcessOfTheMean) {
    Stage stage;
    const SceneTables tables = stage.make(sky_with_a_map(stage));
    const shading::Environment& sky = tables.scene.environment;
    EXPECT_EQ(sky.map.width, 2u);
    EXPECT_EQ(sky.map.wrap_s, shading::WrapRepeat);
    EXPECT_EQ(sky.map.wrap_t, shading::WrapClamp) << "independent of the texture";
    EXPECT_EQ(tables.textures.at(0).wrap_t, shading::WrapMirror);
    // Texels of 2 and 4, smoothed 2.67 and 3.33: the mean of 3 is left to BSDF samples.
    EXPECT_EQ(tables.cdfs[sky.column_cdf], 0.0f);
    EXPECT_EQ(tables.cdfs[sky.column_cdf + 1], 1.0f);
    EXPECT_EQ(tables.cdfs[sky.row_cdf], 1.0f);
    ASSERT_EQ(tables.scene.environment_light, 0);
    EXPECT_EQ(tables.lights[0].layers, shading::AllLayers) << "the sky is for all";
    EXPECT_EQ(tables.lights[0].irradiance, 1.0f) << "there is no other light";
    EXPECT_EQ(tables.scene.features,
              shading::FeatureTextures | shading::FeatureEnvironment | shading::FeatureEnvironmentMap);
}

// Bilinear filtering spreads a bright texel over its neighbours, which light samples have to find as well.
TEST(Tables, EnvironmentWeightsIncludeNeighbouringTexels) {
    Stage stage;
    std::vector<glm::vec3> texels(8, glm::vec3(0.0f));
    texels[3] = glm::vec3(80.0f);
    auto entries = sky_with_a_map(stage);
    auto& map = std::get<scene::Texture>(std::get<Create>(entries[3]).object);
    map.width = 8;
    map.texels = stage.blob(texels);
    std::get<scene::Background>(std::get<Create>(entries[4]).object).color = glm::vec3(0.0f);
    const SceneTables tables = stage.make(std::move(entries));
    const double mean = 10.0, bright = 0.5 * (80.0 + 80.0 / 3) - mean, neighbour = 0.5 * 80.0 / 3 - mean;
    const double total = bright + 2.0 * neighbour;
    const float* cdf = &tables.cdfs[tables.scene.environment.column_cdf];
    EXPECT_EQ(cdf[1], 0.0f);
    EXPECT_NEAR(cdf[2], neighbour / total, 1e-6);
    EXPECT_NEAR(cdf[3], (neighbour + bright) / total, 1e-6);
    EXPECT_EQ(cdf[4], 1.0f);
}

TEST(Tables, AnIncompleteTextureIsLeftOut) {
    Stage stage;
    auto entries = sky_with_a_map(stage);
    std::get<scene::Texture>(std::get<Create>(entries[3]).object).height = 2;
    const SceneTables tables = stage.make(std::move(entries));
    EXPECT_TRUE(tables.textures.empty());
    EXPECT_EQ(tables.materials.at(2).base_color_texture.texture, -1);
    EXPECT_EQ(tables.scene.environment.map.width, 0u);
    EXPECT_EQ(tables.scene.environment.emits, 1u) << "by its colour";
}

// On a device every array has another address.
TEST(Tables, AddressesAreThoseOfTheReader) {
    Stage stage;
    SceneTables tables = stage.make(sky_with_a_map(stage));
    const auto at = [](const scene::BlobPtr& blob) {
        return 0x1000 + 8 * std::uint64_t(blob->hash().bytes[0]);
    };
    std::set<scene::BlobPtr> asked;
    set_addresses(tables, [&](const scene::BlobPtr& blob) {
        asked.insert(blob);
        return at(blob);
    });
    EXPECT_EQ(asked.size(), 3u) << "positions, triangles, texels";
    const auto address = [](const auto* items) { return reinterpret_cast<std::uint64_t>(items); };
    EXPECT_EQ(address(tables.meshes.at(0).positions.items), at(tables.arrays.at(0).positions));
    EXPECT_EQ(address(tables.meshes.at(0).triangles.items), at(tables.arrays.at(0).triangles));
    EXPECT_EQ(address(tables.meshes.at(0).normals.items), 0u);
    EXPECT_EQ(address(tables.textures.at(0).texels.items), at(tables.texels.at(0)));
    EXPECT_EQ(address(tables.scene.environment.map.texels.items), at(tables.texels.at(0)));
}

}  // namespace
}  // namespace tessera::backend
