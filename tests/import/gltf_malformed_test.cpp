#include <glm/geometric.hpp>

#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

// Malformed files: one clear error, or a placeholder while the rest is rendered.
namespace tessera::import {
namespace {

using testing::HasSubstr;

Error error_of(const std::filesystem::path& file) {
    const auto scene = import_scene(file);
    if (scene) {
        ADD_FAILURE() << file << " was read";
        return Error(ErrorCode::Internal, "");
    }
    EXPECT_THAT(scene.error().what(), HasSubstr(file.filename().string())) << "the message names the file";
    EXPECT_LT(std::string(scene.error().what()).size(), 1000u);
    return scene.error();
}

Error error_of(const std::string& name, std::string_view bytes) {
    const TestFolder folder;
    const Error error = error_of(folder.write(name, bytes));
    EXPECT_EQ(error.code(), ErrorCode::InvalidInput);
    return error;
}

// A valid triangle "good" and a mesh "bad" with the given primitive, both in the scene.
ImportedScene with_good_triangle(SceneFile& file, const std::string& primitive) {
    const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    file.add("meshes",
             R"({"name":"good","primitives":[{"attributes":{"POSITION":)" + std::to_string(at) + "}}]}");
    file.add("meshes", R"({"name":"bad","primitives":[)" + primitive + "]}");
    file.add("nodes", R"({"mesh":0})");
    file.add("nodes", R"({"name":"place","mesh":1,"translation":[3,0,0]})");
    file.add("scenes", R"({"nodes":[0,1]})");
    const TestFolder folder;
    ImportedScene scene = loaded(folder.write("scene.glb", file.glb()));
    expect_consistent(scene);
    return scene;
}

void expect_placeholder(const ImportedScene& scene, const std::string& cause) {
    EXPECT_TRUE(has_notice(scene, "mesh 'bad' is invalid"));
    EXPECT_TRUE(has_notice(scene, cause));
    named<scene::Geometry>(scene, "good");
    EXPECT_EQ(scene.counts.placeholders, 1u);
    const scene::Geometry& box = named<scene::Geometry>(scene, "placeholder");
    EXPECT_EQ(object<scene::Material>(scene, box.material).base_color, glm::vec4(1, 0, 1, 1));
    const auto& children = named<scene::Transform>(scene, "place").children;
    ASSERT_EQ(children.size(), 1u);
    EXPECT_EQ(&object<scene::Geometry>(scene, children[0]), &box);
}

TEST(GltfMalformed, ThePlaceholderIsAClosedUnitBoxThatFacesOutwards) {
    SceneFile file;
    const ImportedScene scene = with_good_triangle(file, R"({"attributes":{"POSITION":99}})");
    const scene::Geometry& box = named<scene::Geometry>(scene, "placeholder");
    const auto positions = values<glm::vec3>(scene, box.positions);
    const auto indices = values<std::uint32_t>(scene, box.indices);
    double volume = 0.0, area = 0.0;
    for (std::size_t i = 0; i < indices.size(); i += 3) {
        const glm::dvec3 a(positions[indices[i]]), b(positions[indices[i + 1]]), c(positions[indices[i + 2]]);
        volume += glm::dot(a, glm::cross(b, c)) / 6.0;
        area += glm::length(glm::cross(b - a, c - a)) / 2.0;
    }
    EXPECT_NEAR(volume, 1.0, 1e-12);
    EXPECT_NEAR(area, 6.0, 1e-12);
}

TEST(GltfMalformed, AMissingFileIsNotFound) {
    const TestFolder folder;
    EXPECT_EQ(error_of(folder.path() / "none.glb").code(), ErrorCode::NotFound);
}

TEST(GltfMalformed, AFolderIsRefused) {
    const TestFolder folder;
    std::filesystem::create_directory(folder.path() / "folder.glb");
    EXPECT_EQ(error_of(folder.path() / "folder.glb").code(), ErrorCode::InvalidInput);
}

TEST(GltfMalformed, OtherContentIsNoGltf) {
    EXPECT_THAT(error_of("scene.gltf", "").what(), HasSubstr("not a complete glTF"));
    EXPECT_THAT(error_of("scene.glb", "").what(), HasSubstr("not a complete glTF"));
    EXPECT_THAT(error_of("scene.glb", "PK\x03\x04 a zip file, renamed").what(),
                HasSubstr("not a complete glTF"));
    EXPECT_THAT(error_of("scene.gltf", "[1,2,3]").what(), HasSubstr("not a complete glTF"));
    EXPECT_THAT(error_of("scene.gltf", "{\"asset\":").what(), HasSubstr("not a complete glTF"));
    EXPECT_THAT(error_of("scene.gltf", "{\"scenes\":[]}").what(), HasSubstr("asset"));
    EXPECT_THAT(error_of("scene.txt", "hello").what(), HasSubstr("convert it to glTF 2.0"));
}

TEST(GltfMalformed, OtherVersionsAreNamed) {
    EXPECT_THAT(error_of("scene.gltf", R"({"asset":{"version":"1.0"}})").what(),
                HasSubstr("version is '1.0'"));
    std::string glb = glb_of("{}", "");
    glb[4] = 1;
    EXPECT_THAT(error_of("scene.glb", glb).what(), HasSubstr("version 1"));
}

TEST(GltfMalformed, ATruncatedGlbIsReported) {
    SceneFile file;
    file.add_triangle();
    const std::string glb = file.glb();
    for (const std::size_t length : {std::size_t{4}, std::size_t{19}, std::size_t{30}, glb.size() - 1}) {
        EXPECT_THAT(error_of("scene.glb", glb.substr(0, length)).what(), HasSubstr("cut off"));
    }
}

TEST(GltfMalformed, LengthsOfTheGlbFrameAreChecked) {
    SceneFile file;
    file.add_triangle();
    for (const std::size_t field : {8u, 12u}) {
        std::string glb = file.glb();
        for (std::size_t i = 0; i < 4; ++i) glb[field + i] = '\xff';
        EXPECT_THAT(error_of("scene.glb", glb).what(), HasSubstr("damaged"));
    }
}

TEST(GltfMalformed, AnUnknownRequiredExtensionIsNamed) {
    SceneFile file;
    file.add_triangle();
    file.set("extensionsRequired", R"(["KHR_mesh_quantization","ACME_rockets","ACME_glue"])");
    EXPECT_THAT(error_of("scene.glb", file.glb()).what(), HasSubstr("(ACME_rockets, ACME_glue)"));
}

TEST(GltfMalformed, IndicesOutOfRangeAreAPlaceholder) {
    SceneFile file;
    const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const int indices = file.indices({0, 1, 3});
    expect_placeholder(with_good_triangle(file, R"({"attributes":{"POSITION":)" + std::to_string(at) +
                                                    R"(},"indices":)" + std::to_string(indices) + "}"),
                       "refers to vertex 3 of 3");
}

TEST(GltfMalformed, AMissingIndexAccessorIsAPlaceholder) {
    for (const std::string index : {"77", "-3", "4294967295"}) {
        SceneFile file;
        const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
        const std::string primitive =
            R"({"indices":)" + index + R"(,"attributes":{"POSITION":)" + std::to_string(at) + "}}";
        expect_placeholder(with_good_triangle(file, primitive), "is missing");
    }
}

TEST(GltfMalformed, PositionsThatAreNotFiniteAreAPlaceholder) {
    for (const float bad :
         {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
        SceneFile file;
        const int at = file.positions({{0, 0, 0}, {1, bad, 0}, {0, 1, 0}});
        expect_placeholder(
            with_good_triangle(file, R"({"attributes":{"POSITION":)" + std::to_string(at) + "}}"),
            "positions are not finite");
    }
}

TEST(GltfMalformed, AMeshWithoutPositionsOrTrianglesIsAPlaceholder) {
    {
        SceneFile file;
        expect_placeholder(with_good_triangle(file, R"({"attributes":{"NORMAL":0}})"), "no positions");
    }
    {
        SceneFile file;
        const int at = file.positions({{0, 0, 0}, {1, 0, 0}});
        expect_placeholder(
            with_good_triangle(file, R"({"attributes":{"POSITION":)" + std::to_string(at) + "}}"),
            "no triangles");
    }
    {
        SceneFile file;
        const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
        expect_placeholder(
            with_good_triangle(file, R"({"attributes":{"POSITION":)" + std::to_string(at) + R"(},"mode":9})"),
            "mode 9 is unknown");
    }
}

TEST(GltfMalformed, ABadMeshIsReportedOnceHoweverOftenItIsDrawn) {
    SceneFile file;
    file.add_triangle();
    file.add(
        "meshes",
        R"({"name":"bad","primitives":[{"attributes":{"POSITION":50}},{"attributes":{"POSITION":51}}]})");
    file.add("nodes", R"({"mesh":1})");
    file.add("nodes", R"({"mesh":1,"children":[1]})");
    file.add("scenes", R"({"nodes":[0,2]})");
    file.set("scene", "1");
    const TestFolder folder;
    const ImportedScene scene = loaded(folder.write("scene.glb", file.glb()));
    EXPECT_EQ(
        std::count_if(scene.notices.begin(), scene.notices.end(),
                      [](const std::string& notice) { return notice.starts_with("mesh 'bad' is invalid"); }),
        1);
    EXPECT_EQ(scene.counts.placeholders, 1u);
    EXPECT_EQ(scene.counts.instances, 3u);
}

// Accessors out of bounds, as positions of the bad mesh.
TEST(GltfMalformed, AccessorsAndViewsAreBoundsChecked) {
    const std::string view_of_three = R"({"buffer":0,"byteOffset":0,"byteLength":36})";
    struct Case {
        std::string view, accessor;
    };
    const auto accessor = [](const std::string& more) {
        return R"({"bufferView":0,"componentType":5126,"type":"VEC3",)" + more + "}";
    };
    const std::vector<Case> cases{
        {view_of_three, accessor(R"("count":4)")},
        {view_of_three, accessor(R"("count":3,"byteOffset":4)")},
        {view_of_three, accessor(R"("count":3,"byteOffset":18446744073709551612)")},
        {view_of_three, accessor(R"("count":4294967296)")},
        {view_of_three, accessor(R"("count":1537228672809129302)")},  // times 12 is 2^64 + 8
        {view_of_three, accessor(R"("count":18446744073709551615)")},
        {view_of_three, R"({"bufferView":0,"componentType":5126,"type":"VEC2","count":3})"},
        {view_of_three, R"({"bufferView":0,"componentType":5126,"type":"MAT4","count":3})"},
        {view_of_three, R"({"bufferView":0,"componentType":5124,"type":"VEC3","count":3})"},
        {view_of_three, R"({"bufferView":0,"componentType":5130,"type":"VEC3","count":1})"},
        {view_of_three, R"({"bufferView":9,"componentType":5126,"type":"VEC3","count":3})"},
        {view_of_three,
         R"({"componentType":5126,"type":"VEC3","count":4000000000})"},  // zeros without a buffer
        {R"({"buffer":0,"byteOffset":0,"byteLength":36,"byteStride":4})", accessor(R"("count":3)")},
        {R"({"buffer":0,"byteOffset":0,"byteLength":36,"byteStride":252})", accessor(R"("count":3)")},
        {R"({"buffer":0,"byteOffset":0,"byteLength":4000000000})", accessor(R"("count":100000000)")},
        {R"({"buffer":0,"byteOffset":18446744073709551600,"byteLength":36})", accessor(R"("count":3)")},
        {R"({"buffer":3,"byteOffset":0,"byteLength":36})", accessor(R"("count":3)")},
        {R"({"buffer":-1,"byteOffset":0,"byteLength":36})", accessor(R"("count":3)")},
        {view_of_three,
         accessor(R"("count":3,"sparse":{"count":4,"indices":{"bufferView":0,"componentType":5121},)"
                  R"("values":{"bufferView":0}})")},
        {view_of_three,
         accessor(R"("count":3,"sparse":{"count":-1,"indices":{"bufferView":0,"componentType":5121},)"
                  R"("values":{"bufferView":0}})")},
        {view_of_three,
         accessor(R"("count":3,"sparse":{"count":1,"indices":{"bufferView":0,"componentType":5126},)"
                  R"("values":{"bufferView":0}})")},
        {view_of_three,
         accessor(R"("count":3,"sparse":{"count":1,"indices":{"bufferView":0,"componentType":5121,)"
                  R"("byteOffset":-8},"values":{"bufferView":0}})")},
        {view_of_three,
         accessor(
             R"("count":3,"sparse":{"count":2,"indices":{"bufferView":0,"componentType":5125,)"
             R"("byteOffset":12},"values":{"bufferView":0}})")},  // 1.0f read as an index is out of range
    };
    for (const Case& each : cases) {
        SCOPED_TRACE(each.view + " " + each.accessor);
        SceneFile file;
        file.add("bufferViews", each.view);
        const int bad = file.add("accessors", each.accessor);
        // The first bytes of the buffer are a good triangle's positions.
        const std::vector<glm::vec3> triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        const int at = file.accessor(file.view(triangle), Component::Float, "VEC3", 3);
        file.add("meshes",
                 R"({"name":"good","primitives":[{"attributes":{"POSITION":)" + std::to_string(at) + "}}]}");
        file.add("meshes",
                 R"({"name":"bad","primitives":[{"attributes":{"POSITION":)" + std::to_string(bad) + "}}]}");
        file.add("nodes", R"({"mesh":0})");
        file.add("nodes", R"({"name":"place","mesh":1})");
        file.add("scenes", R"({"nodes":[0,1]})");
        const TestFolder folder;
        const ImportedScene scene = loaded(folder.write("scene.glb", file.glb()));
        expect_consistent(scene);
        expect_placeholder(scene, "primitive 0: ");
    }
}

TEST(GltfMalformed, CyclesAndSecondParentsAreCut) {
    SceneFile file;
    file.add_triangle();  // node 0
    file.add("nodes", R"({"children":[2,0]})");
    file.add("nodes", R"({"children":[3]})");
    file.add("nodes", R"({"children":[2,3,1,0,-1,50]})");
    file.add("scenes", R"({"nodes":[1]})");
    file.set("scene", "1");
    const TestFolder folder;
    const ImportedScene scene = loaded(folder.write("scene.glb", file.glb()));
    expect_consistent(scene);
    EXPECT_EQ(scene.counts.instances, 1u);
    for (const char* node : {"0", "1", "2", "3"}) {
        EXPECT_TRUE(
            has_notice(scene, std::string("node ") + node + " has several parents or is its own ancestor"));
    }
    EXPECT_TRUE(has_notice(scene, "node -1 is missing"));
    EXPECT_TRUE(has_notice(scene, "node 50 is missing"));
}

TEST(GltfMalformed, ALadderOfSharedChildrenStaysSmall) {
    // Each node is a child of the previous one twice: 2^60 instances if expanded.
    SceneFile file;
    const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    file.add("meshes", R"({"primitives":[{"attributes":{"POSITION":)" + std::to_string(at) + "}}]}");
    for (int i = 1; i <= 60; ++i) {
        file.add("nodes", R"({"mesh":0,"children":[)" + std::to_string(i) + "," + std::to_string(i) + "]}");
    }
    file.add("nodes", R"({"mesh":0})");
    file.add("scenes", R"({"nodes":[0]})");
    const TestFolder folder;
    EXPECT_EQ(loaded(folder.write("scene.glb", file.glb())).counts.instances, 61u);
}

TEST(GltfMalformed, DeepChainsOfNodesAreCut) {
    SceneFile file;
    const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    file.add("meshes", R"({"primitives":[{"attributes":{"POSITION":)" + std::to_string(at) + "}}]}");
    for (int i = 1; i <= 100000; ++i)
        file.add("nodes", R"({"mesh":0,"children":[)" + std::to_string(i) + "]}");
    file.add("nodes", R"({"mesh":0})");
    file.add("scenes", R"({"nodes":[0]})");
    const TestFolder folder;
    const ImportedScene scene = loaded(folder.write("scene.glb", file.glb()));
    EXPECT_TRUE(has_notice(scene, "nested more than"));
    EXPECT_LT(scene.counts.instances, 2000u);
}

TEST(GltfMalformed, DeepJsonIsRefused) {
    const std::string deep(1'000'000, '[');
    EXPECT_THAT(error_of("scene.gltf", R"({"asset":{"version":"2.0"},"extras":)" + deep).what(),
                HasSubstr("nested"));
    std::string objects;
    for (int i = 0; i < 100'000; ++i) objects += "{\"a\":";
    EXPECT_THAT(error_of("scene.glb", glb_of(R"({"asset":{"version":"2.0"},"extras":)" + objects, "")).what(),
                HasSubstr("nested"));
}

TEST(GltfMalformed, InvalidTransformsAreReplacedOrCut) {
    const auto drawn = [](const std::string& transform) {
        SceneFile file;
        const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
        file.add("meshes", R"({"primitives":[{"attributes":{"POSITION":)" + std::to_string(at) + "}}]}");
        file.add("nodes", R"({"mesh":0})");
        file.add("nodes", R"({"name":"odd","mesh":0,)" + transform + "}");
        file.add("scenes", R"({"nodes":[0,1]})");
        const TestFolder folder;
        ImportedScene scene = loaded(folder.write("scene.glb", file.glb()));
        expect_consistent(scene);
        return scene;
    };
    for (const std::string wrong :
         {R"("rotation":[0,0,0,0])", R"("rotation":[0,0,1])", R"("translation":[1e30,0,0])",
          R"("matrix":[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,0])", R"("matrix":[1,2,3])",
          R"("matrix":[1e200,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1])"}) {
        const ImportedScene scene = drawn(wrong);
        EXPECT_TRUE(has_notice(scene, "its transform is ignored")) << wrong;
        EXPECT_EQ(named<scene::Transform>(scene, "odd").matrix, glm::dmat4(1.0)) << wrong;
        EXPECT_EQ(scene.counts.instances, 2u);
    }
    for (const std::string flat : {R"("scale":[0,1,1])", R"("scale":[0,0,0])", R"("scale":[1e-300,1,1])",
                                   R"("matrix":[1,0,0,0, 1,0,0,0, 0,0,1,0, 0,0,0,1])"}) {
        const ImportedScene scene = drawn(flat);
        EXPECT_TRUE(has_notice(scene, "transform is degenerate")) << flat;
        EXPECT_EQ(scene.counts.instances, 1u);
    }
}

TEST(GltfMalformed, AChainOfScalesThatOverflowsIsCut) {
    SceneFile file;
    const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    file.add("meshes", R"({"primitives":[{"attributes":{"POSITION":)" + std::to_string(at) + "}}]}");
    for (int i = 1; i <= 40; ++i) {
        file.add("nodes", R"({"mesh":0,"scale":[1e9,1e9,1e9],"children":[)" + std::to_string(i) + "]}");
    }
    file.add("nodes", R"({"mesh":0})");
    file.add("scenes", R"({"nodes":[0]})");
    const TestFolder folder;
    const ImportedScene scene = loaded(folder.write("scene.glb", file.glb()));
    expect_consistent(scene);
    EXPECT_EQ(scene.counts.instances, 1u);
    for (int i = 0; i < 16; ++i) EXPECT_TRUE(std::isfinite(scene.cameras[0].world_from_camera[i / 4][i % 4]));
}

TEST(GltfMalformed, NothingToDrawIsAnError) {
    EXPECT_THAT(error_of("scene.gltf", R"({"asset":{"version":"2.0"}})").what(),
                HasSubstr("nothing to render"));
    SceneFile empty;
    empty.add("meshes", R"({"name":"hull","primitives":[]})");
    empty.add("nodes", R"({"mesh":0})");
    EXPECT_THAT(
        error_of("scene.glb", empty.glb()).what(),
        HasSubstr("no triangles (mesh 'hull' has no list of primitives): there is nothing to render"));
}

TEST(GltfMalformed, InstancesWithoutDataAreNotCreated) {
    SceneFile file;
    const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const int many = file.add("accessors", R"({"componentType":5126,"type":"VEC3","count":16000000})");
    file.add("meshes", R"({"primitives":[{"attributes":{"POSITION":)" + std::to_string(at) + "}}]}");
    file.add("nodes", R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":)" +
                          std::to_string(many) + "}}}}");
    file.add("scenes", R"({"nodes":[0]})");
    const TestFolder folder;
    const ImportedScene scene = loaded(folder.write("scene.glb", file.glb()));
    EXPECT_TRUE(has_notice(scene, "its instances are invalid"));
    EXPECT_EQ(scene.counts.instances, 1u);
}

TEST(GltfMalformed, FilesOutsideTheScenesFolderAreNotOpened) {
    SceneFile file;
    file.add_triangle();
    const TestFolder folder;
    folder.write("secret.bin", file.buffer());
    folder.write("scene/good.bin", file.buffer());
    folder.write("scene/deeper/good file.bin", file.buffer());
    std::filesystem::create_symlink(folder.path() / "secret.bin", folder.path() / "scene/link.bin");
    const auto with_uri = [&](const std::string& uri) {
        return folder.write("scene/scene.gltf", file.json(uri));
    };
    EXPECT_TRUE(import_scene(with_uri("good.bin")));
    EXPECT_TRUE(import_scene(with_uri("./good.bin")));
    EXPECT_TRUE(import_scene(with_uri("deeper/good%20file.bin")));
    for (const std::string& uri :
         {std::string("../secret.bin"), std::string("deeper/../../secret.bin"),
          std::string("%2e%2e/secret.bin"), (folder.path() / "secret.bin").string(),
          "file://" + (folder.path() / "secret.bin").string(), std::string("http://localhost/secret.bin"),
          std::string("link.bin"), std::string("/dev/zero"), std::string("deeper")}) {
        const Error error = error_of(with_uri(uri));
        EXPECT_EQ(error.code(), ErrorCode::InvalidInput) << uri;
    }
    EXPECT_THAT(error_of(with_uri("../secret.bin")).what(), HasSubstr("not a relative path"));
    EXPECT_THAT(error_of(with_uri("link.bin")).what(), HasSubstr("link out of the scene's folder"));
    EXPECT_THAT(error_of(with_uri("absent.bin")).what(), HasSubstr("no file 'absent.bin'"));
}

TEST(GltfMalformed, WrongOptionsAreRefused) {
    SceneFile file;
    file.add_triangle();
    const TestFolder folder;
    const auto path = folder.write("scene.glb", file.glb());
    ImportOptions options;
    options.background = glm::vec3(std::numeric_limits<float>::quiet_NaN());
    EXPECT_FALSE(import_scene(path, options));
    options.background = glm::vec3(-1.0f);
    EXPECT_FALSE(import_scene(path, options));
    options = {};
    options.first_id = scene::RootId;
    EXPECT_FALSE(import_scene(path, options));
    options = {};
    options.environment = folder.path() / "none.exr";
    const auto refused = import_scene(path, options);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().what(), HasSubstr("none.exr"));
}

}  // namespace
}  // namespace tessera::import
