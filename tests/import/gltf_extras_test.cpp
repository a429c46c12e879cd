// Invalid values in the tessera_* extras of glTF files.
#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

namespace tessera::import {
namespace {

ImportedScene load_extras(const SceneFile& file) {
    const TestFolder folder;
    ImportedScene scene = loaded(folder.write("scene.glb", file.glb()));
    expect_consistent(scene);
    expect_valid(scene);
    return scene;
}

SceneFile with_light(const std::string& extras) {
    SceneFile file;
    file.add_triangle();
    file.set("extensionsUsed", R"(["KHR_lights_punctual"])");
    file.set("extensions", R"({"KHR_lights_punctual":{"lights":[{"name":"lamp","type":"point","extras":)" +
                               extras + "}]}}");
    file.add("nodes", R"({"extensions":{"KHR_lights_punctual":{"light":0}}})");
    file.add("scenes", R"({"nodes":[0,1]})");
    file.set("scene", "1");
    return file;
}

TEST(GltfExtras, OfAnotherTypeOrOutOfRangeAreReportedAndTheRestIsUsed) {
    const ImportedScene scene = load_extras(with_light(
        R"({"tessera_light":{"kind":"quad","radius":-1,"size":[1],"angle":"wide","outer_cone_angle":1e40,"gamma":1,"heat":2}})"));
    const auto& light = named<scene::Light>(scene, "lamp");
    EXPECT_EQ(light.kind, scene::LightKind::Quad);
    EXPECT_EQ(light.radius, scene::Light{}.radius);
    EXPECT_EQ(light.size, scene::Light{}.size);
    EXPECT_EQ(light.angle, 0.0f);
    for (const char* part :
         {"light 'lamp': its radius cannot be used (radius is -1: it has to be at least 0",
          "its size cannot be used (it is of another type): its default is used, correct it",
          "its angle cannot be used (it is of another type)",
          "its outer_cone_angle cannot be used (outer_cone_angle is inf: it has to be from 0 to",
          "its extras have no field 'gamma' and 1 others: these are ignored"})
        EXPECT_TRUE(has_notice(scene, part));
}

TEST(GltfExtras, ThatAreNotObjectsAreIgnored) {
    for (const char* extras : {"{}", "null", "7", R"("tessera_light")", R"({"tessera_light":[1,2]})"}) {
        const ImportedScene scene = load_extras(with_light(extras));
        EXPECT_EQ(named<scene::Light>(scene, "lamp").kind, scene::LightKind::Point) << extras;
    }
    const ImportedScene scene = load_extras(with_light(R"({"tessera_light":{"kind":"tube"}})"));
    EXPECT_EQ(named<scene::Light>(scene, "lamp").kind, scene::LightKind::Point);
    EXPECT_TRUE(has_notice(scene, "its kind cannot be used"));
}

TEST(GltfExtras, OfMediaMayBeMissing) {
    for (const char* media :
         {"", R"({"tessera_media":[]})", R"({"tessera_media":7})", R"({"tessera_media":[1,2,3,4]})"}) {
        SceneFile file;
        const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
        file.add("meshes", R"({"primitives":[{"extras":{"tessera_medium":3},"attributes":{"POSITION":)" +
                               std::to_string(at) + "}}]}");
        file.add("nodes", R"({"mesh":0})");
        file.add("scenes", R"({"nodes":[0]})");
        if (*media) file.set("extras", media);
        const ImportedScene scene = load_extras(file);
        EXPECT_TRUE(has_notice(scene, "medium 3 is missing: the meshes that use it have no interior medium"))
            << media;
        EXPECT_TRUE(all<scene::Geometry>(scene).at(0)->material) << "its surface is there";
    }
}

TEST(GltfExtras, OfAnInvalidTextureDepthGiveOneSlice) {
    for (const char* depth : {"3", "0", "-1", R"("deep")"}) {
        SceneFile file;
        file.add_triangle();
        file.image(png(4, 4, {1, 2, 3, 4}));
        file.add("textures", std::string(R"({"source":0,"extras":{"tessera_depth":)") + depth + "}}");
        file.add("materials", R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":1}}})");
        const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
        file.add("meshes",
                 R"({"primitives":[{"material":0,"attributes":{"POSITION":)" + std::to_string(at) + "}}]}");
        file.add("nodes", R"({"mesh":1})");
        file.add("scenes", R"({"nodes":[1]})");
        file.set("scene", "1");
        const ImportedScene scene = load_extras(file);
        EXPECT_TRUE(has_notice(scene, "its height is not a multiple of its tessera_depth")) << depth;
        const auto& texture = *all<scene::Texture>(scene).at(0);
        EXPECT_EQ(glm::uvec3(texture.width, texture.height, texture.depth), glm::uvec3(4, 4, 1));
    }
}

}  // namespace
}  // namespace tessera::import
