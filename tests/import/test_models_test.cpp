#include <fstream>

#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

// Odd and malformed files of Debian's assimp-testmodels (in deploy/packages.txt).
namespace tessera::import {
namespace {

const std::filesystem::path Models = "/usr/share/assimp/models";

ImportedScene sound(const std::string& name) {
    ImportedScene scene = loaded(Models / name);
    expect_sound(scene);
    return scene;
}

void expect_refused(const std::string& name, const std::string& cause) {
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
        const ImportedScene scene = sound(name);
        EXPECT_EQ(scene.counts.triangles, 12u);
        EXPECT_EQ(scene.counts.textures, 1u);
        EXPECT_EQ(scene.counts.placeholders, 0u);
        EXPECT_EQ(all<scene::Texture>(scene)[0]->width, 211u);
        EXPECT_TRUE(has_notice(scene, "no camera"));
    }
}

TEST(TestModels, TheEngineIsTheSameWithDracoAndWithout) {
    const ImportedScene plain = sound("glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb");
    const ImportedScene draco = sound("glTF2/draco/2CylinderEngine.gltf");
    EXPECT_EQ(plain.counts.geometries, draco.counts.geometries);
    EXPECT_EQ(plain.counts.instances, draco.counts.instances);
    EXPECT_GT(plain.counts.triangles, 60'000u);
    // The compressor has dropped the triangles without area.
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
            const ImportedScene scene = sound(name);
            EXPECT_TRUE(has_notice(scene, "points and lines are drawn as thin bodies"));
            EXPECT_EQ(scene.counts.placeholders, 0u);
        } else {
            EXPECT_EQ(sound(name).counts.triangles, 2u);
        }
    }
}

TEST(TestModels, X3dFilesThatAskForMoreThanIsRead) {
    const ImportedScene globe = sound("X3D/HelloX3dTrademark.x3d");
    EXPECT_EQ(globe.counts.instances, 1u);
    EXPECT_EQ(globe.cameras.size(), 1u);
    EXPECT_TRUE(has_notice(globe, "<ImageTexture> of <Appearance> cannot be used"));
    EXPECT_TRUE(has_notice(globe, "<ROUTE> skipped: not read, or not in such a place (line 45 and 1 more)"));
    expect_refused("X3D/ComputerKeyboard.x3d", "no shape that is read (skipped: 3 <Extrusion>");
}

TEST(TestModels, CamerasAndTextureTransforms) {
    const ImportedScene cameras = sound("glTF2/cameras/Cameras.gltf");
    EXPECT_EQ(cameras.cameras.size(), 2u);
    const ImportedScene transforms = sound("glTF2/textureTransform/TextureTransformTest.gltf");
    EXPECT_EQ(transforms.counts.placeholders, 0u);
    bool rotated = false;
    for (const scene::Material* material : all<scene::Material>(transforms)) {
        rotated |= material->base_color_texture.rotation != 0.0f;
    }
    EXPECT_TRUE(rotated);
}

TEST(TestModels, WhatIsNotSupportedIsNoticed) {
    EXPECT_TRUE(has_notice(sound("glTF2/BoxTextured-glTF-pbrSpecularGlossiness/BoxTextured.gltf"),
                           "KHR_materials_pbrSpecularGlossiness is ignored"));
    const ImportedScene coats = sound("glTF2/ClearCoat-glTF/ClearCoatTest.gltf");
    EXPECT_EQ(coats.counts.placeholders, 0u);
    EXPECT_TRUE(has_notice(coats, "no light but what glows faintly")) << "its labels";
}

TEST(TestModels, BadMeshesArePlaceholders) {
    EXPECT_EQ(sound("glTF2/IndexOutOfRange/IndexOutOfRange.gltf").counts.placeholders, 1u);
    EXPECT_EQ(sound("glTF2/IndexOutOfRange/AllIndicesOutOfRange.gltf").counts.placeholders, 1u);
    EXPECT_EQ(sound("glTF2/BoxWithInfinites-glTF-Binary/BoxWithInfinites.glb").counts.placeholders, 1u);
    EXPECT_EQ(sound("glTF2/BoxBadNormals-glTF-Binary/BoxBadNormals.glb").counts.triangles, 12u);
    EXPECT_TRUE(has_notice(sound("glTF2/IncorrectVertexArrays/Cube.gltf"),
                           "mesh 'TruncatedCube': its last 2 vertices make no triangle"));
}

TEST(TestModels, ValuesOfWrongTypesAreToldOrRefused) {
    const std::string folder = "glTF2/wrongTypes/bad";
    EXPECT_TRUE(has_notice(sound(folder + "Extension.gltf"), "KHR_texture_transform is \"Not an object\""));
    EXPECT_TRUE(has_notice(sound(folder + "Number.gltf"), "material 'Texture': normalTexture is "));
    EXPECT_TRUE(has_notice(sound(folder + "Object.gltf"), "pbrMetallicRoughness is [\"not an object\"]"));
    EXPECT_TRUE(has_notice(sound(folder + "Uint.gltf"), "baseColorTexture is {\"index\":-1}"));
    expect_refused(folder + "Array.gltf", "mesh 'Mesh' has no list of primitives");
}

TEST(TestModels, FilesThatCannotBeReadAreOneClearError) {
    expect_refused("glTF2/RecursiveNodes/RecursiveNodes.gltf", "inside itself");
    expect_refused("glTF2/TestNoRootNode/NoScene.gltf", "nothing to draw");
    expect_refused("glTF2/TestNoRootNode/SceneWithoutNodes.gltf", "nothing to draw");
    expect_refused("glTF2/MissingBin/BoxTextured.gltf", "there is no file 'BoxTextured0.bin'");
    expect_refused("glTF2/SchemaFailures/sceneWrongType.gltf", ":");
    expect_refused("invalid/empty.obj", "cannot be read");
    expect_refused("invalid/empty.ply", "no complete PLY");
    expect_refused("PLY/points.ply", "only points");
    expect_refused("invalid/OutOfMemory.off", "convert it to glTF 2.0");
}

TEST(TestModels, EveryGltfOfThePackageEndsInASoundSceneOrAnError) {
    int files = 0, scenes = 0;
    for (const char* folder : {"glTF", "glTF2", "invalid"}) {
        for (const auto& entry : std::filesystem::recursive_directory_iterator(Models / folder)) {
            const std::string extension = entry.path().extension();
            if (extension != ".gltf" && extension != ".glb") continue;
            SCOPED_TRACE(entry.path());
            ++files;
            const auto scene = import_scene(entry.path());
            if (scene) expect_sound(*scene);
            scenes += scene ? 1 : 0;
        }
    }
    EXPECT_GT(files, 40);
    EXPECT_GT(scenes, 20);
}

TEST(TestModels, ObjAndPlyAreRead) {
    EXPECT_EQ(sound("OBJ/box.obj").counts.triangles, 12u);
    EXPECT_EQ(sound("PLY/cube.ply").counts.triangles, 12u);
    EXPECT_EQ(sound("PLY/cube_binary.ply").counts.triangles, 12u);
    const ImportedScene colored = sound("OBJ/cube_with_vertexcolors.obj");
    EXPECT_FALSE(all<scene::Geometry>(colored)[0]->colors.empty());
    EXPECT_FALSE(all<scene::Geometry>(sound("PLY/cube_uv.ply"))[0]->tex_coords.empty());
    const ImportedScene spider = sound("OBJ/spider.obj");
    EXPECT_GT(spider.counts.triangles, 1000u);
    EXPECT_GT(spider.counts.textures, 0u);
    for (const scene::Material* material : all<scene::Material>(spider)) EXPECT_EQ(material->metallic, 0.0f);
}

TEST(TestModels, EveryObjAndPlyEndsInASoundSceneOrAnError) {
    int files = 0;
    for (const char* folder : {"OBJ", "PLY", "invalid"}) {
        for (const auto& entry : std::filesystem::directory_iterator(Models / folder)) {
            SCOPED_TRACE(entry.path());
            const auto scene = import_scene(entry.path());
            if (scene) expect_sound(*scene);
            ++files;
        }
    }
    EXPECT_GT(files, 30);
}

TEST(ObjFile, BadValuesAreToldAndTheirDefaultsStand) {
    const TestFolder folder;
    folder.write("a.mtl", "newmtl odd\nKd 2 0 0\nd -1\nKe -1 0 0\nKs 1 1 1\nNs -5\nmap_Kd lost.png\n");
    const ImportedScene scene = loaded(folder.write(
        "a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl odd\nf 1/1 2/1 3/1\n"));
    expect_sound(scene);
    for (const char* told :
         {"diffuse colour is 2 0 0, outside 0 to 1: its default", "opacity is -1, outside 0 to 1",
          "emission is -1 0 0, outside 0 to", "shininess is -5, outside 0 to"}) {
        EXPECT_TRUE(has_notice(scene, std::string("material 'odd': its ") + told));
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
    expect_sound(scene);
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
