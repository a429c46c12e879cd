#include <draco/attributes/geometry_attribute.h>
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>

#include <glm/geometric.hpp>
#include <glm/gtc/type_precision.hpp>

#include "mediator/base/random.h"
#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

namespace tessera::import {
namespace {

struct Compressed {
    std::string bytes;
    std::uint32_t position = 0, normal = 0, tex_coord = 0;  // unique ids
};

// A unit square of two triangles that faces +z.
Compressed compressed_square(draco::MeshEncoderMethod method = draco::MESH_EDGEBREAKER_ENCODING) {
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(2);
    const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    const int normal = builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
    const int tex_coord = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
    const glm::vec3 corners[2][3] = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 0}, {1, 0, 0}, {1, 1, 0}}};
    const glm::vec3 up(0, 0, 1);
    for (std::uint32_t i = 0; i < 2; ++i) {
        const auto& [a, b, c] = corners[i];
        const glm::vec2 ta(a), tb(b), tc(c);
        builder.SetAttributeValuesForFace(position, draco::FaceIndex(i), &a, &b, &c);
        builder.SetAttributeValuesForFace(normal, draco::FaceIndex(i), &up, &up, &up);
        builder.SetAttributeValuesForFace(tex_coord, draco::FaceIndex(i), &ta, &tb, &tc);
    }
    const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
    draco::Encoder encoder;
    encoder.SetEncodingMethod(method);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
    return {std::string(buffer.data(), buffer.size()), mesh->attribute(position)->unique_id(),
            mesh->attribute(normal)->unique_id(), mesh->attribute(tex_coord)->unique_id()};
}

// A triangle whose corners follow joint 0, joint 1, and both with equal weight.
struct CompressedSkin {
    std::string bytes;
    std::uint32_t position = 0, joints = 0, weights = 0;  // unique ids
};

CompressedSkin compressed_skin() {
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(1);
    using draco::GeometryAttribute;
    const int position = builder.AddAttribute(GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    const int joints = builder.AddAttribute(GeometryAttribute::GENERIC, 4, draco::DT_UINT16);
    const int weights = builder.AddAttribute(GeometryAttribute::GENERIC, 4, draco::DT_FLOAT32);
    const glm::vec3 corners[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const glm::u16vec4 joint_values[3] = {{0, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 0}};
    const glm::vec4 weight_values[3] = {{1, 0, 0, 0}, {1, 0, 0, 0}, {0.5f, 0.5f, 0, 0}};
    const draco::FaceIndex face(0);
    builder.SetAttributeValuesForFace(position, face, &corners[0], &corners[1], &corners[2]);
    builder.SetAttributeValuesForFace(joints, face, &joint_values[0], &joint_values[1], &joint_values[2]);
    builder.SetAttributeValuesForFace(weights, face, &weight_values[0], &weight_values[1], &weight_values[2]);
    const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
    draco::Encoder encoder;
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
    return {std::string(buffer.data(), buffer.size()), mesh->attribute(position)->unique_id(),
            mesh->attribute(joints)->unique_id(), mesh->attribute(weights)->unique_id()};
}

// The skin's second joint is 10 m above its bind pose.
SceneFile skin_file(const CompressedSkin& skin, const std::string& weights) {
    SceneFile file;
    const int view = file.view_of_bytes(skin.bytes);
    const int of_joints = file.add("accessors", R"({"componentType":5123,"type":"VEC4","count":3})");
    const int of_floats = file.add("accessors", R"({"componentType":5126,"type":"VEC3","count":3})");
    const auto number = [](auto value) { return std::to_string(value); };
    file.add("meshes", R"({"name":"arm","primitives":[{"attributes":{"POSITION":)" + number(of_floats) +
                           R"(,"JOINTS_0":)" + number(of_joints) + R"(,"WEIGHTS_0":)" + number(of_joints) +
                           R"(},"extensions":{"KHR_draco_mesh_compression":{"bufferView":)" + number(view) +
                           R"(,"attributes":{"POSITION":)" + number(skin.position) + R"(,"JOINTS_0":)" +
                           number(skin.joints) + weights + "}}}}]}");
    file.add("nodes", R"({"mesh":0,"skin":0})");
    file.add("nodes", "{}");
    file.add("nodes", R"({"translation":[0,10,0]})");
    file.add("skins", R"({"joints":[1,2]})");
    file.add("scenes", R"({"nodes":[0,1,2]})");
    return file;
}

// As exporters write it: accessors without buffer views, the data in the extension.
enum class WithIndices { No, Yes };
SceneFile draco_file(const Compressed& square, std::uint32_t position_id,
                     WithIndices with_indices = WithIndices::Yes) {
    SceneFile file;
    file.set("extensionsRequired", R"(["KHR_draco_mesh_compression"])");
    const int view = file.view_of_bytes(square.bytes);
    const int indices = file.add("accessors", R"({"componentType":5123,"type":"SCALAR","count":6})");
    const int position = file.add("accessors", R"({"componentType":5126,"type":"VEC3","count":4})");
    const int uv = file.add("accessors", R"({"componentType":5126,"type":"VEC2","count":4})");
    file.add("meshes",
             R"({"name":"bad","primitives":[{"attributes":{"POSITION":)" + std::to_string(position) +
                 R"(,"NORMAL":)" + std::to_string(position) + R"(,"TEXCOORD_0":)" + std::to_string(uv) + "}" +
                 (with_indices == WithIndices::Yes ? R"(,"indices":)" + std::to_string(indices) : "") +
                 R"(,"extensions":{"KHR_draco_mesh_compression":{"bufferView":)" + std::to_string(view) +
                 R"(,"attributes":{"POSITION":)" + std::to_string(position_id) + R"(,"NORMAL":)" +
                 std::to_string(square.normal) + R"(,"TEXCOORD_0":)" + std::to_string(square.tex_coord) +
                 "}}}}]}");
    file.add("nodes", R"({"mesh":0})");
    file.add("scenes", R"({"nodes":[0]})");
    return file;
}

TEST(Draco, ATriangleWithAVertexThatDoesNotExistIsRefused) {
    Compressed square = compressed_square(draco::MESH_SEQUENTIAL_ENCODING);
    constexpr std::size_t LastIndex =
        19;  // header of 11 bytes, counts of faces and points, a method, six indices
    ASSERT_LT(square.bytes[LastIndex], 4);
    square.bytes[LastIndex] = 100;
    const TestFolder folder;
    const ImportedScene scene = loaded(folder.write("scene.glb", draco_file(square, square.position).glb()));
    EXPECT_EQ(scene.counts.placeholders, 1u);
    EXPECT_THAT(scene.notices, testing::Contains(testing::HasSubstr("vertex that does not exist")));
}

TEST(Draco, ACompressedMeshIsDecoded) {
    const Compressed square = compressed_square();
    const TestFolder folder;
    const ImportedScene scene = loaded(folder.write("scene.glb", draco_file(square, square.position).glb()));
    expect_consistent(scene);
    EXPECT_EQ(scene.counts.triangles, 2u);
    EXPECT_EQ(scene.counts.placeholders, 0u);
    const scene::Geometry& mesh = *all<scene::Geometry>(scene).front();
    const auto positions = values<glm::vec3>(scene, mesh.positions);
    const auto tex_coords = values<glm::vec2>(scene, mesh.tex_coords);
    const auto indices = values<std::uint32_t>(scene, mesh.indices);
    ASSERT_EQ(positions.size(), 4u);
    float area = 0.0f;
    for (std::size_t i = 0; i < 6; i += 3) {
        const glm::vec3 a = positions[indices[i]], b = positions[indices[i + 1]],
                        c = positions[indices[i + 2]];
        area += 0.5f * glm::cross(b - a, c - a).z;
    }
    EXPECT_NEAR(area, 1.0f, 1e-3f);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_NEAR(glm::distance(glm::vec2(positions[i]), tex_coords[i]), 0.0f, 1e-2f);
    }
    EXPECT_NEAR(values<glm::vec3>(scene, mesh.normals)[0].z, 1.0f, 1e-2f);
}

TEST(Draco, JointsAndWeightsAreDecoded) {
    const CompressedSkin skin = compressed_skin();
    const TestFolder folder;
    const std::string weights = R"(,"WEIGHTS_0":)" + std::to_string(skin.weights);
    const ImportedScene scene = loaded(folder.write("scene.glb", skin_file(skin, weights).glb()));
    expect_consistent(scene);
    for (const std::string& notice : scene.notices)
        EXPECT_FALSE(notice.find("skin") != notice.npos) << notice;
    std::vector<float> heights;
    for (const glm::vec3& at : values<glm::vec3>(scene, all<scene::Geometry>(scene).front()->positions))
        heights.push_back(at.y);
    // (0, 0), (1, 0) and (0, 1), moved by 0, 10 and 5 m.
    EXPECT_THAT(heights, testing::UnorderedElementsAre(0.0f, 10.0f, 6.0f));
}

TEST(Draco, JointsWithoutWeightsAreAPlaceholder) {
    const TestFolder folder;
    const ImportedScene scene = loaded(folder.write("scene.glb", skin_file(compressed_skin(), "").glb()));
    EXPECT_TRUE(has_notice(scene, "its Draco data lacks WEIGHTS_0"));
    EXPECT_EQ(scene.counts.placeholders, 1u);
}

TEST(Draco, AnAttributeThatIsNotThereIsAPlaceholder) {
    const TestFolder folder;
    const ImportedScene scene = loaded(folder.write("scene.glb", draco_file(compressed_square(), 77).glb()));
    EXPECT_TRUE(has_notice(scene, "its Draco data has no attribute POSITION"));
    EXPECT_EQ(scene.counts.placeholders, 1u);
}

TEST(Draco, CountsOfTheDataAreCheckedBeforeItIsDecoded) {
    constexpr std::size_t HeaderBytes = 11;
    struct Case {
        draco::MeshEncoderMethod method;
        std::size_t faces;  // where their count is
    };
    for (const Case& each : {Case{draco::MESH_EDGEBREAKER_ENCODING, HeaderBytes + 2},
                             Case{draco::MESH_SEQUENTIAL_ENCODING, HeaderBytes}}) {
        SCOPED_TRACE(each.method);
        const TestFolder folder;
        Compressed square = compressed_square(each.method);
        const auto import = [&](WithIndices with_indices) {
            return loaded(folder.write("scene.glb", draco_file(square, square.position, with_indices).glb()));
        };
        EXPECT_EQ(import(WithIndices::Yes).counts.placeholders, 0u);
        EXPECT_EQ(import(WithIndices::No).counts.placeholders, 0u);
        ASSERT_EQ(square.bytes[each.faces], 2);
        square.bytes.replace(each.faces, 1, "\xff\xff\xff\x07");  // of seven bits each
        EXPECT_TRUE(
            has_notice(import(WithIndices::Yes), "claims 16777215 triangles, but its indices state 2"));
        EXPECT_TRUE(has_notice(import(WithIndices::No), "claims 16777215 triangles, but has only"));
        square.bytes.replace(each.faces, 4, "\xff\xff\xff\xff\x01");
        EXPECT_TRUE(has_notice(import(WithIndices::No), "triangles, more than the 16777216 that are read"));
    }
}

TEST(Draco, DamagedDataIsAPlaceholderOrAMesh) {
    const Compressed square = compressed_square();
    const TestFolder folder;
    CounterRandom random(99);
    std::uint64_t placeholders = 0;
    for (int round = 0; round < 300; ++round) {
        Compressed damaged = square;
        if (round % 3 == 0) {
            damaged.bytes.resize(random.below(damaged.bytes.size()) + 1);
        } else {
            char& byte = damaged.bytes[random.below(damaged.bytes.size())];
            byte = static_cast<char>(byte ^ (1 << random.below(8)));
        }
        SCOPED_TRACE("round " + std::to_string(round));
        const ImportedScene scene =
            loaded(folder.write("scene.glb", draco_file(damaged, square.position).glb()));
        expect_consistent(scene);
        placeholders += scene.counts.placeholders;
    }
    EXPECT_GT(placeholders, 50u);
}

}  // namespace
}  // namespace tessera::import
