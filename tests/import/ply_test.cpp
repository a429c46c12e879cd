#include <bit>
#include <cmath>

#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

namespace tessera::import {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

template <class T>
void append(std::string& to, T value, bool big_endian) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    to += big_endian ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

std::string ply_error(const std::string& ply) {
    const TestFolder folder;
    const auto scene = import_scene(folder.write("shape.ply", ply));
    EXPECT_FALSE(scene);
    if (scene) return "";
    EXPECT_EQ(scene.error().code(), ErrorCode::InvalidInput);
    return scene.error().what();
}

constexpr const char* Vertices = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
constexpr const char* Faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

TEST(Ply, ReadsTextWithEveryAttributeAndCutsPolygonsIntoFans) {
    const TestFolder folder;
    const ImportedScene scene = loaded(folder.write(
        "square.ply", std::string("ply\nformat ascii 1.0\ncomment hello\na stray line\n") + Vertices +
                          "property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\n"
                          "property uchar green\nproperty uchar blue\nproperty float s\nproperty float t\n"
                          "element other 2\nproperty list uchar float stuff\n" +
                          Faces +
                          "0 0 0 0 0 1 255 0 188 0 0\n1 0 0 0 0 1 0 0 0 1 0\n1 1 0 0 0 1 0 0 0 1 1\n"
                          "0 1 0 0 0 1 0 0 0 0 1\n2 1.5 2.5\n0\n4 0 1 2 3\n"));
    expect_consistent(scene);
    const scene::Geometry& mesh = named<scene::Geometry>(scene, "square");
    EXPECT_EQ(scene.counts.triangles, 2u);
    EXPECT_EQ(scene.counts.degenerate_triangles, 0u);
    EXPECT_EQ(values<glm::vec3>(scene, mesh.positions)[2], glm::vec3(1, 1, 0));
    EXPECT_THAT(values<glm::vec3>(scene, mesh.normals), testing::Each(glm::vec3(0, 0, 1)));
    EXPECT_EQ(values<glm::vec2>(scene, mesh.tex_coords)[3], glm::vec2(0, 0)) << "v turned down";
    const glm::vec4 color = values<glm::vec4>(scene, mesh.colors)[0];
    EXPECT_FLOAT_EQ(color.x, 1.0f);
    EXPECT_NEAR(color.z, 0.5029, 1e-4) << "188 of sRGB in linear light";
    EXPECT_EQ(named<scene::Material>(scene, "default").base_color, glm::vec4(1)) << "the colours as they are";
}

TEST(Ply, ReadsBinaryOfEitherByteOrder) {
    for (const bool big_endian : {false, true}) {
        std::string data;
        for (const auto& [x, y, z] : {std::tuple(0.0, 0.0, 0.5), {2.0, 0.0, 0.5}, {0.0, 3.0, 0.5}}) {
            append(data, static_cast<double>(x), big_endian);
            append(data, static_cast<float>(y), big_endian);
            append(data, static_cast<std::int16_t>(7), big_endian);
            append(data, static_cast<float>(z), big_endian);
        }
        append(data, std::uint16_t{3}, big_endian);
        for (const std::uint32_t index : {0u, 1u, 2u}) append(data, index, big_endian);
        const TestFolder folder;
        const ImportedScene scene = loaded(folder.write(
            "t.ply", std::string("ply\r\nformat binary_") + (big_endian ? "big" : "little") +
                         "_endian 1.0\r\nelement vertex 3\r\nproperty double x\r\nproperty float y\r\n"
                         "property short ignored\r\nproperty float z\r\nelement face 1\r\n"
                         "property list ushort uint vertex_index\r\nend_header\r\n" +
                         data));
        expect_consistent(scene);
        EXPECT_THAT(values<glm::vec3>(scene, all<scene::Geometry>(scene)[0]->positions),
                    ElementsAre(glm::vec3(0, 0, 0.5f), glm::vec3(2, 0, 0.5f), glm::vec3(0, 3, 0.5f)));
    }
}

TEST(Ply, MalformedFilesAreOneClearError) {
    const std::string begin = "ply\nformat ascii 1.0\n";
    const std::string points = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    EXPECT_THAT(ply_error(""), HasSubstr("does not begin"));
    EXPECT_THAT(ply_error(begin), HasSubstr("no end"));
    EXPECT_THAT(ply_error(begin + "element vertex 99999999999\nend_header\n"), HasSubstr("can hold"));
    EXPECT_THAT(ply_error(begin + "element vertex -1\nend_header\n"), HasSubstr("can hold"));
    EXPECT_THAT(ply_error(begin + "property float x\nend_header\n"), HasSubstr("property float x"));
    EXPECT_THAT(ply_error(begin + "element face 0\nproperty list float int vertex_indices\nend_header\n"),
                HasSubstr("list float"));
    EXPECT_THAT(ply_error("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n"),
                HasSubstr("lack x, y or z"));
    EXPECT_THAT(ply_error("ply\nend_header\n"), HasSubstr("lacks the format"));
    EXPECT_THAT(ply_error(begin + Vertices + Faces + points), HasSubstr("too early"));
    EXPECT_THAT(ply_error(begin + Vertices + Faces + points + "9000 0 1 2\n"),
                HasSubstr("longer than the data"));
    EXPECT_THAT(ply_error(begin + Vertices + Faces + points + "3 0 one 2\n"), HasSubstr("not a number"));
    EXPECT_THAT(ply_error(begin + Vertices + "end_header\n" + points), HasSubstr("only points"));
}

TEST(Ply, WrongIndicesAndPositionsAreAPlaceholder) {
    const std::string begin = std::string("ply\nformat ascii 1.0\n") + Vertices + Faces;
    for (const std::string data :
         {"0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 4\n", "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 -1\n",
          "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 1e300\n", "0 0 0\n1 0 0\n1e999 1 0\n0 1 0\n3 0 1 2\n",
          "0 0 0\n1 0 0\nnan 1 0\n0 1 0\n3 0 1 2\n"}) {
        const TestFolder folder;
        const ImportedScene scene = loaded(folder.write("shape.ply", begin + data));
        expect_consistent(scene);
        EXPECT_EQ(scene.counts.placeholders, 1u) << data;
        EXPECT_TRUE(has_notice(scene, "mesh 'shape' is invalid"));
    }
}

}  // namespace
}  // namespace tessera::import
