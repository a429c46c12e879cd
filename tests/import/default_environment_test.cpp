#include <cmath>
#include <numbers>

#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

// When a scene gets a default environment, and what it is.
namespace tessera::import {
namespace {

int add_quad(SceneFile& file, float half, int material) {
    const int at = file.positions({{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}});
    const int uv = file.accessor(file.view(std::vector<glm::vec2>{{0, 0}, {1, 0}, {1, 1}, {0, 1}}),
                                 Component::Float, "VEC2", 4);
    const int order = file.indices({0, 1, 2, 0, 2, 3});
    return file.add("meshes", R"({"primitives":[{"attributes":{"POSITION":)" + std::to_string(at) +
                                  R"(,"TEXCOORD_0":)" + std::to_string(uv) + R"(},"indices":)" +
                                  std::to_string(order) + R"(,"material":)" + std::to_string(material) +
                                  "}]}");
}

// A white wall of 10 x 10 m, and an emissive square in front of it with `half` its edge.
ImportedScene wall_and(const std::string& material, float half, const std::string& placed = "",
                       const ImportOptions& options = {}) {
    SceneFile file;
    file.image(png(1, 1, {40, 40, 40, 255}));
    file.add("materials", R"({"pbrMetallicRoughness":{"metallicFactor":0}})");
    file.add("materials", material);
    const int wall = add_quad(file, 5.0f, 0), square = add_quad(file, half, 1);
    file.add("nodes", R"({"mesh":)" + std::to_string(wall) + "}");
    file.add("nodes", R"({"translation":[0,0,1],"mesh":)" + std::to_string(square) + placed + "}");
    file.add("scenes", R"({"nodes":[0,1]})");
    const TestFolder folder;
    ImportedScene scene = loaded(folder.write("scene.glb", file.glb()), options);
    expect_consistent(scene);
    expect_valid(scene);
    return scene;
}

bool has_sky(const ImportedScene& scene) {
    return static_cast<bool>(all<scene::Background>(scene).front()->environment);
}

TEST(DefaultEnvironment, FaintEmissionIsNoLight) {
    const ImportedScene label = wall_and(R"({"emissiveFactor":[1,1,1]})", 0.5f);
    EXPECT_TRUE(has_sky(label));
    EXPECT_EQ(label.counts.emissive_geometries, 1u);
    EXPECT_TRUE(
        has_notice(label, "only faint emission as light: a default environment (overcast sky) was added"));
    EXPECT_TRUE(has_notice(label, "--background 0,0,0"));

    ImportOptions black;
    black.background = glm::vec3(0.0f);
    EXPECT_FALSE(has_sky(wall_and(R"({"emissiveFactor":[1,1,1]})", 0.5f, "", black)));
}

TEST(DefaultEnvironment, LampsAndLargeSurfacesAreLight) {
    const auto unlit_by_the_sky = [](const ImportedScene& scene) {
        EXPECT_FALSE(has_sky(scene));
        EXPECT_FALSE(has_notice(scene, "default environment"));
    };
    unlit_by_the_sky(wall_and(R"({"emissiveFactor":[1,1,1],"extensions":{
        "KHR_materials_emissive_strength":{"emissiveStrength":1.5}}})",
                              0.05f));
    unlit_by_the_sky(wall_and(R"({"emissiveFactor":[1,1,1]})", 5.0f));
    // World area, both sides.
    unlit_by_the_sky(wall_and(R"({"emissiveFactor":[1,1,1]})", 0.5f, R"(,"scale":[10,10,10])"));
}

// Of the sphere around the wall (radius 7.09 m) the irradiance is pi A / (4 pi R^2), with 0.2 at A = 40.2.
TEST(DefaultEnvironment, TheThresholdIsAsDocumented) {
    EXPECT_TRUE(has_sky(wall_and(R"({"emissiveFactor":[1,1,1]})", 3.1f)));
    EXPECT_FALSE(has_sky(wall_and(R"({"emissiveFactor":[1,1,1]})", 3.25f)));
    EXPECT_TRUE(has_sky(wall_and(R"({"emissiveFactor":[0.5,0.5,0.5]})", 3.25f)));
    EXPECT_TRUE(has_sky(wall_and(R"({"emissiveFactor":[1,1,1],"doubleSided":true})", 2.2f)));
    EXPECT_FALSE(has_sky(wall_and(R"({"emissiveFactor":[1,1,1],"doubleSided":true})", 2.3f)));
}

TEST(DefaultEnvironment, TexturesCountByTheirMean) {
    // 40 of 255 in sRGB is 0.021.
    EXPECT_TRUE(has_sky(wall_and(R"({"emissiveFactor":[1,1,1],"emissiveTexture":{"index":0}})", 5.0f)));
    EXPECT_FALSE(has_sky(wall_and(R"({"emissiveFactor":[1,1,1]})", 5.0f)));
}

TEST(DefaultEnvironment, UnlitSurfacesLightNothing) {
    const ImportedScene scene = wall_and(R"({"emissiveFactor":[1,1,1],"extensions":{"KHR_materials_unlit":{},
        "KHR_materials_emissive_strength":{"emissiveStrength":9}}})",
                                         5.0f);
    EXPECT_TRUE(has_sky(scene));
    EXPECT_EQ(scene.counts.emissive_geometries, 0u);
    EXPECT_TRUE(has_notice(scene, "no light: a default environment"));
}

TEST(DefaultEnvironment, IsAnOvercastSkyOverGround) {
    const ImportedScene scene = wall_and("{}", 1.0f);
    const auto& map = object<scene::Texture>(scene, all<scene::Background>(scene).front()->environment);
    const auto texels = values<glm::vec3>(scene, map.texels);
    glm::dvec3 up(0.0), down(0.0);
    const double step = std::numbers::pi / map.height;
    for (std::uint32_t row = 0; row < map.height; ++row) {
        const double from_zenith = (row + 0.5) * step;
        const double weight = 2.0 * std::numbers::pi * std::sin(from_zenith) * std::cos(from_zenith) * step;
        (weight > 0.0 ? up : down) += glm::dvec3(texels[row * map.width]) * std::abs(weight);
    }
    // The midpoint rule errs by step^2 / 24 of the integrand's slopes: below 1e-3 with 64 rows.
    const glm::dvec3 color(0.8, 0.9, 1.0);
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(up[i], std::numbers::pi * color[i], 2e-3 * std::numbers::pi);
        EXPECT_NEAR(down[i], 0.2 * std::numbers::pi * color[i], 2e-3 * std::numbers::pi);
    }
    const glm::vec3 zenith = texels.front(), horizon = texels[(map.height / 2 - 1) * map.width];
    EXPECT_NEAR(zenith.y / horizon.y, 3.0, 0.15) << "half a row above the horizon";
}

}  // namespace
}  // namespace tessera::import
