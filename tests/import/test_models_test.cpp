#include <fstream>

#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

// Odd and malformed files of Debian's assimp-testmodels (in deploy/packages.txt).
namespace tessera::import {
namespace {

const std::filesystem::path Models = "/usr/share/assimp/models";

ImportedScene load_consistent(const std::string& name) {
    ImportedScene scene = loaded(Models / name);
    expect_consistent(scene);
    return scene;
}

void expect_rejected(const std::string& name, const std::string& cause) {
    ASSERT_TRUE(std::filesystem::exists(Models / name)) << "install assimp-testmodels";
    const auto scene = import_scene(Models / name);
    ASSERT_FALSE(scene) << name;
    EXPECT_EQ(scene.error().code(), ErrorCode::InvalidInput);
    EXPECT_THAT(scene.error().what(), testing::HasSubstr(cause));
    EXPECT_THAT(scene.error().what(), testing::HasSubstr(std::filesystem::path(name).filename().string()));
}

TEST(TestModels, TheSameBoxInEveryEncoding) {
    for (const char* name :
         {"glTF2/BoxTextured-glTF/BoxTextured.gltf", "glTF2/BoxTextured-glTF-Binary/BoxTextured.glb",
          "glTF2/BoxTextured-glTF-Embedded/BoxTextured.gltf"}) {
        SCOPED_TRACE(name);
        const ImportedScene scene = load_consistent(name);
        EXPECT_EQ(scene.counts.triangles, 12u);
        EXPECT_EQ(scene.counts.textures, 1u);
        EXPECT_EQ(scene.counts.placeholders, 0u);
        EXPECT_EQ(all<scene::Texture>(scene)[0]->width, 211u);
        EXPECT_TRUE(has_notice(scene, "no camera"));
    }
}

TEST(TestModels, TheEngineIsTheSameWithDracoAndWithout) {
    const ImportedScene plain = load_consistent("glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb");
    const ImportedScene draco = load_consistent("glTF2/draco/2CylinderEngine.gltf");
    EXPECT_EQ(plain.counts.geometries, draco.counts.geometries);
    EXPECT_EQ(plain.counts.instances, draco.counts.instances);
    EXPECT_GT(plain.counts.triangles, 60'000u);
    // The compressor has removed degenerate triangles.
    EXPECT_EQ(plain.counts.triangles - plain.counts.degenerate_triangles, draco.counts.triangles);
    EXPECT_EQ(draco.counts.placeholders, 0u);
}

TEST(TestModels, EveryPrimitiveMode) {
    const std::string folder = "glTF2/glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_";
    for (int i = 0; i < 16; ++i) {
        const std::string name = folder + (i < 10 ? "0" : "") + std::to_string(i) + ".gltf";
        SCOPED_TRACE(name);
        std::ifstream stream(Models / name);
        const std::string text((std::istreambuf_iterator<char>(stream)), {});
        ASSERT_FALSE(text.empty());
        const bool points_or_lines =
            text.find("\"mode\": 0") != text.npos || text.find("\"mode\": 1") != text.npos ||
            text.find("\"mode\": 2") != text.npos || text.find("\"mode\": 3") != text.npos;
        if (points_or_lines) {
            const ImportedScene scene = load_consistent(name);
            EXPECT_TRUE(has_notice(scene, "points and lines are drawn as octahedra and tubes"));
            EXPECT_EQ(scene.counts.placeholders, 0u);
        } else {
            EXPECT_EQ(load_consistent(name).counts.triangles, 2u);
        }
    }
}

TEST(TestModels, X3dFilesWithUnsupportedNodes) {
    const ImportedScene globe = load_consistent("X3D/HelloX3dTrademark.x3d");
    EXPECT_EQ(globe.counts.instances, 1u);
    EXPECT_EQ(globe.cameras.size(), 1u);
    EXPECT_TRUE(has_notice(globe, "<ImageTexture> of <Appearance> cannot be used"));
    EXPECT_TRUE(has_notice(
        globe, "<ROUTE> skipped: unsupported, or not supported in this place (line 45 and 1 more)"));
    expect_rejected("X3D/ComputerKeyboard.x3d", "no supported shape (skipped: 3 <Extrusion>");
}

TEST(TestModels, CamerasAndTextureTransforms) {
    const ImportedScene cameras = load_consistent("glTF2/cameras/Cameras.gltf");
    EXPECT_EQ(cameras.cameras.size(), 2u);
    const ImportedScene transforms = load_consistent("glTF2/textureTransform/TextureTransformTest.gltf");
    EXPECT_EQ(transforms.counts.placeholders, 0u);
    bool rotated = false;
    for (const scene::Material* material : all<scene::Material>(transforms)) {
        rotated |= material->base_color_texture.rotation != 0.0f;
    }
    EXPECT_TRUE(rotated);
}

TEST(TestModels, UnsupportedFeaturesAreReported) {
    EXPECT_TRUE(has_notice(load_consistent("glTF2/BoxTextured-glTF-pbrSpecularGlossiness/BoxTextured.gltf"),
                           "KHR_materials_pbrSpecularGlossiness is ignored"));
    const ImportedScene coats = load_consistent("glTF2/ClearCoat-glTF/ClearCoatTest.gltf");
    EXPECT_EQ(coats.counts.placeholders, 0u);
    EXPECT_TRUE(has_notice(coats, "only faint emission as light")) << "its labels";
}

TEST(TestModels, BadMeshesArePlaceholders) {
    EXPECT_EQ(load_consistent("glTF2/IndexOutOfRange/IndexOutOfRange.gltf").counts.placeholders, 1u);
    EXPECT_EQ(load_consistent("glTF2/IndexOutOfRange/AllIndicesOutOfRange.gltf").counts.placeholders, 1u);
    EXPECT_EQ(load_consistent("glTF2/BoxWithInfinites-glTF-Binary/BoxWithInfinites.glb").counts.placeholders,
              1u);
    EXPECT_EQ(load_consistent("glTF2/BoxBadNormals-glTF-Binary/BoxBadNormals.glb").counts.triangles, 12u);
    EXPECT_TRUE(has_notice(load_consistent("glTF2/IncorrectVertexArrays/Cube.gltf"),
                           "mesh 'TruncatedCube': its last 2 vertices form no triangle"));
}

TEST(TestModels, ValuesOfWrongTypesAreReportedOrRejected) {
    const std::string folder = "glTF2/wrongTypes/bad";
    EXPECT_TRUE(
        has_notice(load_consistent(folder + "Extension.gltf"), "KHR_texture_transform is \"Not an object\""));
    EXPECT_TRUE(has_notice(load_consistent(folder + "Number.gltf"), "material 'Texture': normalTexture is "));
    EXPECT_TRUE(
        has_notice(load_consistent(folder + "Object.gltf"), "pbrMetallicRoughness is [\"not an object\"]"));
    EXPECT_TRUE(has_notice(load_consistent(folder + "Uint.gltf"), "baseColorTexture is {\"index\":-1}"));
    expect_rejected(folder + "Array.gltf", "mesh 'Mesh' has no list of primitives");
}

TEST(TestModels, FilesThatCannotBeReadAreOneClearError) {
    expect_rejected("glTF2/RecursiveNodes/RecursiveNodes.gltf", "its own ancestor");
    expect_rejected("glTF2/TestNoRootNode/NoScene.gltf", "nothing to render");
    expect_rejected("glTF2/TestNoRootNode/SceneWithoutNodes.gltf", "nothing to render");
    expect_rejected("glTF2/MissingBin/BoxTextured.gltf", "there is no file 'BoxTextured0.bin'");
    expect_rejected("glTF2/SchemaFailures/sceneWrongType.gltf", ":");
    expect_rejected("invalid/empty.obj", "cannot be read");
    expect_rejected("invalid/empty.ply", "not a complete PLY");
    expect_rejected("PLY/points.ply", "only points");
    expect_rejected("invalid/OutOfMemory.off", "convert it to glTF 2.0");
}

TEST(TestModels, EveryGltfOfThePackageGivesAValidSceneOrAnError) {
    int files = 0, scenes = 0;
    for (const char* folder : {"glTF", "glTF2", "invalid"}) {
        for (const auto& entry : std::filesystem::recursive_directory_iterator(Models / folder)) {
            const std::string extension = entry.path().extension();
            if (extension != ".gltf" && extension != ".glb") continue;
            SCOPED_TRACE(entry.path());
            ++files;
            const auto scene = import_scene(entry.path());
            if (scene) expect_consistent(*scene);
            scenes += scene ? 1 : 0;
        }
    }
    EXPECT_GT(files, 40);
    EXPECT_GT(scenes, 20);
}

TEST(TestModels, ObjAndPlyAreRead) {
    EXPECT_EQ(load_consistent("OBJ/box.obj").counts.triangles, 12u);
    EXPECT_EQ(load_consistent("PLY/cube.ply").counts.triangles, 12u);
    EXPECT_EQ(load_consistent("PLY/cube_binary.ply").counts.triangles, 12u);
    const ImportedScene colored = load_consistent("OBJ/cube_with_vertexcolors.obj");
    EXPECT_FALSE(all<scene::Geometry>(colored)[0]->colors.empty());
    EXPECT_FALSE(all<scene::Geometry>(load_consistent("PLY/cube_uv.ply"))[0]->tex_coords.empty());
    const ImportedScene spider = load_consistent("OBJ/spider.obj");
    EXPECT_GT(spider.counts.triangles, 1000u);
    EXPECT_GT(spider.counts.textures, 0u);
    for (const scene::Material* material : all<scene::Material>(spider)) EXPECT_EQ(material->metallic, 0.0f);
}

TEST(TestModels, EveryObjAndPlyGivesAValidSceneOrAnError) {
    int files = 0;
    for (const char* folder : {"OBJ", "PLY", "invalid"}) {
        for (const auto& entry : std::filesystem::directory_iterator(Models / folder)) {
            SCOPED_TRACE(entry.path());
            const auto scene = import_scene(entry.path());
            if (scene) expect_consistent(*scene);
            ++files;
        }
    }
    EXPECT_GT(files, 30);
}

TEST(ObjFile, InvalidValuesAreReportedAndGetTheirDefaults) {
    const TestFolder folder;
    folder.write("a.mtl", "newmtl odd\nKd 2 0 0\nd -1\nKe -1 0 0\nKs 1 1 1\nNs -5\nmap_Kd lost.png\n");
    const ImportedScene scene = loaded(folder.write(
        "a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl odd\nf 1/1 2/1 3/1\n"));
    expect_consistent(scene);
    for (const char* expected :
         {"diffuse colour is 2 0 0, outside 0 to 1: its default", "opacity is -1, outside 0 to 1",
          "emission is -1 0 0, outside 0 to", "shininess is -5, outside 0 to"}) {
        EXPECT_TRUE(has_notice(scene, std::string("material 'odd': its ") + expected));
    }
    EXPECT_TRUE(has_notice(scene, "material 'odd': texture 'lost.png' cannot be used"));
    const scene::Material& odd = named<scene::Material>(scene, "odd");
    EXPECT_EQ(odd.base_color, glm::vec4(0.8f, 0.8f, 0.8f, 1.0f));
    EXPECT_EQ(odd.emission, glm::vec3(0.0f));
    EXPECT_EQ(odd.roughness, 1.0f);
}

TEST(ObjFile, MaterialsAndTexturesStayInsideTheFolder) {
    const TestFolder folder;
    folder.write("secret.png", png(1, 1, {1, 2, 3, 4}));
    folder.write("secret.mtl", "newmtl m\nKd 1 0 0\n");
    folder.write("scene/inside.png", png(1, 1, {5, 6, 7, 8}));
    folder.write("scene/good.mtl",
                 "newmtl m\nKd 0.25 0.5 1\nKe 2 0 0\nmap_Kd inside.png\nnewmtl n\nmap_Kd ../secret.png\n");
    const std::string shape = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\n";
    const ImportedScene scene = loaded(folder.write(
        "scene/a.obj", "mtllib good.mtl\n" + shape + "usemtl m\nf 1/1 2/2 3/3\nusemtl n\nf 1/1 2/2 4/3\n"));
    expect_consistent(scene);
    const scene::Material& material = named<scene::Material>(scene, "m");
    EXPECT_EQ(material.base_color, glm::vec4(0.25f, 0.5f, 1.0f, 1.0f));
    EXPECT_EQ(material.emission, glm::vec3(2, 0, 0));
    EXPECT_EQ(object<scene::Texture>(scene, material.base_color_texture.texture).name, "inside.png");
    EXPECT_TRUE(has_notice(scene, "texture '../secret.png' cannot be used"));
    EXPECT_EQ(scene.counts.placeholders, 1u);
    for (const scene::Geometry* mesh : all<scene::Geometry>(scene)) {
        // v up in the file, down in the scene: (0, 0) is the lower left corner of the image.
        EXPECT_EQ(values<glm::vec2>(scene, mesh->tex_coords)[0], glm::vec2(0, 1));
    }

    const ImportedScene outside =
        loaded(folder.write("scene/b.obj", "mtllib ../secret.mtl\n" + shape + "usemtl m\nf 1/1 2/2 3/3\n"));
    for (const scene::Material* each : all<scene::Material>(outside)) {
        EXPECT_NE(each->base_color, glm::vec4(1, 0, 0, 1)) << "read from outside the folder";
    }
}

}  // namespace
}  // namespace tessera::import
