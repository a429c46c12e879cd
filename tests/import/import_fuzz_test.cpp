#include "mediator/base/random.h"
#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

// Fuzzing of small files with fixed seeds: an import gives a valid scene or an error, nothing else.
namespace tessera::import {
namespace {

SceneFile rich_file() {
    SceneFile file;
    file.image(png(2, 2, {200, 100, 50, 255}));
    file.add("materials", R"({"name":"m","pbrMetallicRoughness":{"baseColorTexture":{"index":0}},)"
                          R"("normalTexture":{"index":0},"emissiveFactor":[1,1,1]})");
    const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
    const int normal =
        file.accessor(file.view(std::vector<glm::vec3>(4, {0, 0, 1})), Component::Float, "VEC3", 4);
    const int uv = file.accessor(file.view(std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 1}, {1, 1}}),
                                 Component::Float, "VEC2", 4);
    const int places = file.view(std::vector<std::uint16_t>{1});
    const int replacement = file.view(std::vector<glm::vec3>{{2, 0, 0}});
    const int sparse = file.accessor(
        file.view(std::vector<glm::vec3>(4, {1, 2, 3})), Component::Float, "VEC3", 4,
        R"(,"sparse":{"count":1,"indices":{"bufferView":)" + std::to_string(places) +
            R"(,"componentType":5123},"values":{"bufferView":)" + std::to_string(replacement) + "}}");
    const int indices = file.accessor(file.view(std::vector<std::uint16_t>{0, 1, 2, 2, 1, 3}),
                                      Component::UShort, "SCALAR", 6);
    const std::string attributes = R"("attributes":{"POSITION":)" + std::to_string(at) + R"(,"NORMAL":)" +
                                   std::to_string(normal) + R"(,"TEXCOORD_0":)" + std::to_string(uv) + "}";
    file.add("meshes", R"({"primitives":[{)" + attributes + R"(,"material":0,"indices":)" +
                           std::to_string(indices) + R"(},{"mode":5,"attributes":{"POSITION":)" +
                           std::to_string(sparse) + "}}]}");
    file.add("cameras", R"({"type":"perspective","perspective":{"yfov":0.7,"znear":0.1}})");
    file.set("extensions", R"({"KHR_lights_punctual":{"lights":[{"type":"point","intensity":5}]}})");
    file.add("nodes", R"({"children":[1,2],"rotation":[0,0,0,1]})");
    file.add("nodes", R"({"mesh":0,"scale":[1,2,1],"extensions":{"EXT_mesh_gpu_instancing":{"attributes":)"
                      R"({"TRANSLATION":)" +
                          std::to_string(at) + "}}}}");
    file.add("nodes",
             R"({"camera":0,"translation":[0,0,5],"extensions":{"KHR_lights_punctual":{"light":0}}})");
    file.add("scenes", R"({"nodes":[0]})");
    file.set("scene", "0");
    return file;
}

// Imports the bytes as a file; returns whether there was a scene.
bool survives(const TestFolder& folder, const std::string& name, const std::string& bytes) {
    const auto scene = import_scene(folder.write(name, bytes));
    if (scene) {
        expect_consistent(*scene);
        expect_valid(*scene);
    } else {
        EXPECT_STRNE(scene.error().what(), "");
        EXPECT_NE(scene.error().code(), ErrorCode::Internal);
    }
    return scene.has_value();
}

TEST(ImportFuzz, TheUndamagedFileIsRead) {
    const TestFolder folder;
    EXPECT_TRUE(survives(folder, "whole.glb", rich_file().glb()));
    EXPECT_TRUE(survives(folder, "whole.gltf", rich_file().gltf()));
}

TEST(ImportFuzz, EveryTruncationOfAGlb) {
    const TestFolder folder;
    const std::string glb = rich_file().glb();
    for (std::size_t length = 0; length < glb.size(); length += 7) {
        EXPECT_FALSE(survives(folder, "cut.glb", glb.substr(0, length))) << length;
    }
}

TEST(ImportFuzz, TruncationsOfText) {
    const TestFolder folder;
    const std::string text = rich_file().gltf();
    for (std::size_t length = 0; length < text.size(); length += 11) {
        EXPECT_FALSE(survives(folder, "cut.gltf", text.substr(0, length))) << length;
    }
}

TEST(ImportFuzz, FlippedBits) {
    const TestFolder folder;
    const std::string glb = rich_file().glb();
    CounterRandom random(20240611);
    int read = 0;
    for (int round = 0; round < 600; ++round) {
        std::string damaged = glb;
        const std::uint64_t flips = 1 + random.below(4);
        for (std::uint64_t i = 0; i < flips; ++i) {
            char& byte = damaged[random.below(damaged.size())];
            byte = static_cast<char>(byte ^ (1 << random.below(8)));
        }
        SCOPED_TRACE("round " + std::to_string(round));
        read += survives(folder, "flipped.glb", damaged) ? 1 : 0;
    }
    EXPECT_GT(read, 50) << "damage that always stops the parser tests nothing behind it";
}

TEST(ImportFuzz, NumbersOfTheTextReplaced) {
    const TestFolder folder;
    const SceneFile file = rich_file();
    const std::string json = file.json();
    std::vector<std::pair<std::size_t, std::size_t>> numbers;
    for (std::size_t i = 0; i < json.size(); ++i) {
        if (!std::isdigit(static_cast<unsigned char>(json[i]))) continue;
        std::size_t end = i;
        while (std::isdigit(static_cast<unsigned char>(json[end]))) ++end;
        if (i > 0 && (json[i - 1] == ':' || json[i - 1] == ',' || json[i - 1] == '['))
            numbers.emplace_back(i, end);
        i = end;
    }
    const std::vector<std::string> evil{"-1",
                                        "0",
                                        "1",
                                        "2",
                                        "65535",
                                        "2147483648",
                                        "4294967295",
                                        "4294967296",
                                        "9223372036854775807",
                                        "18446744073709551615",
                                        "1e30",
                                        "-0.5",
                                        "null",
                                        "{}",
                                        "[]",
                                        "\"x\"",
                                        "[[0]]",
                                        "true"};
    ASSERT_GT(numbers.size(), 40u);
    int read = 0;
    for (const auto& [begin, end] : numbers) {
        for (const std::string& value : evil) {
            const std::string changed = json.substr(0, begin) + value + json.substr(end);
            SCOPED_TRACE(value + " in ..." + json.substr(begin - std::min<std::size_t>(begin, 40), 60));
            read += survives(folder, "changed.glb", glb_of(changed, file.buffer())) ? 1 : 0;
        }
    }
    EXPECT_GT(read, 200);
}

TEST(ImportFuzz, FlippedBitsOfOtherFormats) {
    const std::string obj =
        "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv .2 .3 0\nvt 0 0\nvn 0 0 1\nusemtl m\n"
        "f 1/1/1 2/1/1 5/1/1 4/1/1 3/1/1\nf -1 -2 -3\nl 1 2\np 1\nf 1//1 2//1 4//1 3//1\n";
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    std::string binary_ply =
        "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
        "property float z\nproperty uchar red\nelement face 1\nproperty list uchar int "
        "vertex_indices\nend_header\n";
    binary_ply.append(52, '\0').append("\4\0\0\0\0\1\0\0\0\2\0\0\0\3\0\0\0", 17);
    const std::string stl =
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
        "0\nendloop\nendfacet\n"
        "endsolid a\n";
    const std::string x3d =
        "<X3D version='3.3'><Scene><Transform DEF='T' rotation='0 1 0 2'><Shape "
        "DEF='S'><Appearance><Material "
        "diffuseColor='1 0 0'/><ImageTexture url='\"t.png\"'/><TextureTransform scale='2 2'/></Appearance>"
        "<IndexedFaceSet convex='false' creaseAngle='1' coordIndex='0 1 2 3 -1 0 1 3' colorIndex='0 1' "
        "colorPerVertex='false'><Coordinate point='0 0 0,1 0 0,1 1 0,0 1 0'/><Color color='1 0 0 0 1 0'/>"
        "<TextureCoordinate point='0 0 1 0 1 1 0 1'/></IndexedFaceSet></Shape></Transform><Group><Transform "
        "USE='T'/><Shape USE='S'/></Group><SpotLight direction='0 1 0'/><Viewpoint position='0 0 3'/>"
        "<Shape><Appearance><CommonSurfaceShader shininessFactor='1 2' relativeIndexOfRefraction='1.5' "
        "normalSpace="
        "'OBJECT'><ImageTexture containerField='normalTexture' "
        "url='t.png'/></CommonSurfaceShader><CommonVolumeShader "
        "scatteringFactor='1 2 3'/></Appearance><Cone height='3'/></Shape><Background skyColor='1 1 1 0 0 0' "
        "skyAngle='1.5' groundColor='.1 .1 .1'/></Scene></X3D>";
    const TestFolder folder;
    folder.write("t.png", png(2, 2, {200, 100, 50, 255}));
    CounterRandom random(7);
    int read = 0;
    for (int round = 0; round < 200; ++round) {
        for (const auto& [name, whole] :
             {std::pair("a.obj", obj), std::pair("a.ply", ply), std::pair("b.ply", binary_ply),
              std::pair("a.stl", stl), std::pair("a.x3d", x3d)}) {
            std::string damaged = whole;
            for (std::uint64_t flips = 1 + random.below(3); flips > 0; --flips) {
                char& byte = damaged[random.below(damaged.size())];
                byte = static_cast<char>(byte ^ (1 << random.below(8)));
            }
            if (random.below(10) == 0) damaged.resize(random.below(damaged.size()));
            SCOPED_TRACE(std::string(name) + "\n" + damaged);
            read += survives(folder, name, damaged) ? 1 : 0;
        }
    }
    EXPECT_GT(read, 50);
}

}  // namespace
}  // namespace tessera::import
