#include <cmath>
#include <glm/geometric.hpp>

#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

namespace tessera::import {
namespace {

using scene::Geometry;
using testing::ElementsAre;

// A scene of one mesh with one primitive, whose JSON is given.
ImportedScene scene_of(SceneFile& file, const std::string& primitive) {
    file.add("meshes", R"({"name":"it","primitives":[)" + primitive + "]}");
    file.add("nodes", R"({"mesh":0})");
    file.add("scenes", R"({"nodes":[0]})");
    const TestFolder folder;
    ImportedScene scene = loaded(folder.write("scene.glb", file.glb()));
    expect_consistent(scene);
    return scene;
}

std::vector<glm::vec3> square() {
    return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
}

std::string attribute(const std::string& name, int accessor) {
    return '"' + name + "\":" + std::to_string(accessor);
}

std::string primitive(const std::string& attributes, const std::string& more = "") {
    return R"({"attributes":{)" + attributes + "}" + more + "}";
}

TEST(GltfMesh, WithoutIndicesTakesVerticesInOrder) {
    SceneFile file;
    const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}});
    const ImportedScene scene = scene_of(file, primitive(attribute("POSITION", at)));
    const Geometry& mesh = named<Geometry>(scene, "it");
    EXPECT_THAT(values<std::uint32_t>(scene, mesh.indices), ElementsAre(0, 1, 2, 3, 4, 5));
    EXPECT_EQ(values<glm::vec3>(scene, mesh.positions)[3], glm::vec3(0, 0, 1));
    EXPECT_TRUE(mesh.normals.empty()) << "a mesh without normals is flat-shaded: none are generated";
    EXPECT_EQ(scene.counts.triangles, 2u);
    EXPECT_EQ(scene.counts.degenerate_triangles, 0u);
}

TEST(GltfMesh, ReadsIndicesOfEveryWidth) {
    const auto read = [](auto zero, Component component) {
        using T = decltype(zero);
        SceneFile file;
        const int at = file.positions(square());
        const int view = file.view(std::vector<T>{0, 1, 2, 2, 1, 3});
        const int indices = file.accessor(view, component, "SCALAR", 6);
        const ImportedScene scene =
            scene_of(file, primitive(attribute("POSITION", at), ",\"indices\":" + std::to_string(indices)));
        return values<std::uint32_t>(scene, named<Geometry>(scene, "it").indices);
    };
    EXPECT_THAT(read(std::uint8_t{}, Component::UByte), ElementsAre(0, 1, 2, 2, 1, 3));
    EXPECT_THAT(read(std::uint16_t{}, Component::UShort), ElementsAre(0, 1, 2, 2, 1, 3));
    EXPECT_THAT(read(std::uint32_t{}, Component::UInt), ElementsAre(0, 1, 2, 2, 1, 3));
}

TEST(GltfMesh, StripsAndFansKeepTheWinding) {
    for (const int mode : {5, 6}) {
        SceneFile file;
        const std::vector<glm::vec3> strip{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}};
        const std::vector<glm::vec3> fan{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {-1, 1, 0}};
        const int at = file.positions(mode == 5 ? strip : fan);
        const ImportedScene scene =
            scene_of(file, primitive(attribute("POSITION", at), ",\"mode\":" + std::to_string(mode)));
        const Geometry& mesh = named<Geometry>(scene, "it");
        const auto indices = values<std::uint32_t>(scene, mesh.indices);
        const auto positions = values<glm::vec3>(scene, mesh.positions);
        ASSERT_EQ(indices.size(), 9u);
        for (std::size_t i = 0; i < 9; i += 3) {
            const glm::vec3 a = positions[indices[i]], b = positions[indices[i + 1]],
                            c = positions[indices[i + 2]];
            EXPECT_GT(glm::cross(b - a, c - a).z, 0.0f) << "triangle " << i / 3 << " of mode " << mode;
        }
    }
}

// Octahedra of volume 4/3 r^3 and prisms of 3 sqrt(3)/4 r^2 per metre, r = 0.2 % of the diagonal; the volume
// is positive if all faces are outward.
TEST(GltfMesh, PointsAndLinesBecomeOctahedraAndTubes) {
    const double r = 0.002 * std::sqrt(2.0), octahedron = 4.0 / 3.0 * r * r * r;
    const double prism = 0.75 * std::sqrt(3.0) * r * r;
    const struct {
        int mode;
        std::uint64_t triangles;
        double volume;
    } Cases[] = {{0, 32, 4.0 * octahedron}, {1, 16, 2.0 * prism}, {2, 32, 4.0 * prism}, {3, 24, 3.0 * prism}};
    for (const auto& expected : Cases) {
        SCOPED_TRACE(expected.mode);
        SceneFile file;
        const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
        const ImportedScene scene = scene_of(
            file, primitive(attribute("POSITION", at), ",\"mode\":" + std::to_string(expected.mode)));
        EXPECT_TRUE(has_notice(scene, "mesh 'it': its points and lines are drawn as octahedra and tubes"));
        EXPECT_EQ(scene.counts.triangles, expected.triangles);
        EXPECT_EQ(scene.counts.degenerate_triangles, 0u);
        const Geometry& mesh = named<Geometry>(scene, "it");
        const auto indices = values<std::uint32_t>(scene, mesh.indices);
        const auto positions = values<glm::vec3>(scene, mesh.positions);
        double volume = 0.0;
        for (std::size_t i = 0; i < indices.size(); i += 3) {
            const glm::dvec3 a(positions[indices[i]]), b(positions[indices[i + 1]]),
                c(positions[indices[i + 2]]);
            volume += glm::dot(a, glm::cross(b, c)) / 6.0;
        }
        // Positions are rounded to 2^-24 of a metre, r is 2.8 mm: 6e-5 of r, in the volume up to three times.
        EXPECT_NEAR(volume, expected.volume, 2e-4 * expected.volume);
    }
}

TEST(GltfMesh, ReadsInterleavedAndNormalizedIntegers) {
    // KHR_mesh_quantization: shorts as positions, bytes as normals, both in one strided view.
    struct Vertex {
        std::int16_t position[4];
        std::int8_t normal[4];
    };
    SceneFile file;
    file.set("extensionsRequired", R"(["KHR_mesh_quantization"])");
    const std::vector<Vertex> vertices{{{0, 0, 0, 0}, {0, 0, 127, 0}},
                                       {{300, 0, 0, 0}, {0, 0, -128, 0}},
                                       {{0, 16384, 0, 0}, {0, 127, 0, 0}}};
    const int view = file.view(vertices, sizeof(Vertex));
    const int at = file.accessor(view, Component::Short, "VEC3", 3);
    const int normal =
        file.accessor(view, Component::Byte, "VEC3", 3, R"(,"byteOffset":8,"normalized":true)");
    const int color = file.accessor(
        file.view(std::vector<glm::u16vec4>{{0, 65535, 13107, 65535}, {65535, 0, 0, 0}, {65535, 0, 0, 0}}),
        Component::UShort, "VEC4", 3, R"(,"normalized":true)");
    const ImportedScene scene =
        scene_of(file, primitive(attribute("POSITION", at) + "," + attribute("NORMAL", normal) + "," +
                                 attribute("COLOR_0", color)));
    const Geometry& mesh = named<Geometry>(scene, "it");
    EXPECT_THAT(values<glm::vec3>(scene, mesh.positions),
                ElementsAre(glm::vec3(0), glm::vec3(300, 0, 0), glm::vec3(0, 16384, 0)));
    EXPECT_THAT(values<glm::vec3>(scene, mesh.normals),
                ElementsAre(glm::vec3(0, 0, 1), glm::vec3(0, 0, -1), glm::vec3(0, 1, 0)));
    const glm::vec4 first = values<glm::vec4>(scene, mesh.colors)[0];
    EXPECT_FLOAT_EQ(first.y, 1.0f);
    EXPECT_FLOAT_EQ(first.z, 0.2f);
}

TEST(GltfMesh, SparseElementsReplaceThoseOfTheViewOrOfZeros) {
    for (const bool backed : {true, false}) {
        SceneFile file;
        const int base = file.view(square());
        const int places = file.view(std::vector<std::uint16_t>{1, 2});
        const int replacements = file.view(std::vector<glm::vec3>{{5, 0, 0}, {0, 7, 0}});
        const std::string sparse =
            R"("sparse":{"count":2,"indices":{"bufferView":)" + std::to_string(places) +
            R"(,"componentType":5123},"values":{"bufferView":)" + std::to_string(replacements) + "}}";
        const int at = backed ? file.accessor(base, Component::Float, "VEC3", 4, "," + sparse)
                              : file.add("accessors",
                                         R"({"componentType":5126,"type":"VEC3","count":4,)" + sparse + "}");
        const ImportedScene scene = scene_of(file, primitive(attribute("POSITION", at), R"(,"mode":5)"));
        EXPECT_THAT(values<glm::vec3>(scene, named<Geometry>(scene, "it").positions),
                    ElementsAre(glm::vec3(0), glm::vec3(5, 0, 0), glm::vec3(0, 7, 0),
                                backed ? glm::vec3(1, 1, 0) : glm::vec3(0)));
    }
}

TEST(GltfMesh, CountsDegenerateTrianglesAndKeepsThem) {
    SceneFile file;
    const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}});
    const int indices = file.indices({0, 1, 2, 1, 1, 2, 0, 1, 3});
    const ImportedScene scene =
        scene_of(file, primitive(attribute("POSITION", at), ",\"indices\":" + std::to_string(indices)));
    EXPECT_EQ(scene.counts.triangles, 3u);
    EXPECT_EQ(scene.counts.degenerate_triangles, 2u);
}

TEST(GltfMesh, TextureCoordinatesKeepVDown) {
    SceneFile file;
    const int at = file.positions({{0, 1, 0}, {0, 0, 0}, {1, 0, 0}});
    const int uv =
        file.accessor(file.view(std::vector<glm::vec2>{{0, 0}, {0, 1}, {1, 1}}), Component::Float, "VEC2", 3);
    const ImportedScene scene =
        scene_of(file, primitive(attribute("POSITION", at) + "," + attribute("TEXCOORD_0", uv)));
    EXPECT_THAT(values<glm::vec2>(scene, named<Geometry>(scene, "it").tex_coords),
                ElementsAre(glm::vec2(0, 0), glm::vec2(0, 1), glm::vec2(1, 1)));
}

// A square that faces +z, textured upright (mirrored: u grows to the left), under a normal map.
ImportedScene normal_mapped(const std::vector<glm::vec2>& tex_coords, bool with_normals) {
    SceneFile file;
    const int texture = file.image(png(1, 1, {128, 128, 255, 255}));
    file.add("materials", R"({"normalTexture":{"index":)" + std::to_string(texture) + "}}");
    const int at = file.positions(square());
    const int uv = file.accessor(file.view(tex_coords), Component::Float, "VEC2", 4);
    const int indices = file.indices({0, 1, 2, 2, 1, 3});
    std::string attributes = attribute("POSITION", at) + "," + attribute("TEXCOORD_0", uv);
    if (with_normals) {
        const std::vector<glm::vec3> normals(4, glm::vec3(0, 0, 1));
        attributes +=
            "," + attribute("NORMAL", file.accessor(file.view(normals), Component::Float, "VEC3", 4));
    }
    return scene_of(file, primitive(attributes, R"(,"material":0,"indices":)" + std::to_string(indices)));
}

TEST(GltfMesh, TangentsAreGeneratedForNormalMaps) {
    const ImportedScene upright = normal_mapped({{0, 1}, {1, 1}, {0, 0}, {1, 0}}, true);
    for (const glm::vec4& tangent : values<glm::vec4>(upright, named<Geometry>(upright, "it").tangents)) {
        EXPECT_NEAR(glm::distance(tangent, glm::vec4(1, 0, 0, 1)), 0.0f, 1e-6f);
    }
    const ImportedScene mirrored = normal_mapped({{1, 1}, {0, 1}, {1, 0}, {0, 0}}, true);
    for (const glm::vec4& tangent : values<glm::vec4>(mirrored, named<Geometry>(mirrored, "it").tangents)) {
        EXPECT_NEAR(glm::distance(tangent, glm::vec4(-1, 0, 0, -1)), 0.0f, 1e-6f);
    }
}

TEST(GltfMesh, AMirroredSeamSplitsItsVertices) {
    // The second triangle is mirrored in texture space at the shared edge.
    const ImportedScene scene = normal_mapped({{0, 1}, {1, 1}, {0.5f, 0}, {0, 0.5f}}, true);
    const auto tangents = values<glm::vec4>(scene, named<Geometry>(scene, "it").tangents);
    int left_handed = 0, right_handed = 0;
    for (const std::uint32_t index : values<std::uint32_t>(scene, named<Geometry>(scene, "it").indices)) {
        (tangents[index].w < 0.0f ? left_handed : right_handed)++;
    }
    EXPECT_EQ(right_handed, 3);
    EXPECT_EQ(left_handed, 3);
    EXPECT_EQ(tangents.size(), 6u);
}

TEST(GltfMesh, ANormalMapOnAMeshWithoutNormalsMakesItFlat) {
    const ImportedScene scene = normal_mapped({{0, 1}, {1, 1}, {0, 0}, {1, 0}}, false);
    const Geometry& mesh = named<Geometry>(scene, "it");
    EXPECT_THAT(values<glm::vec3>(scene, mesh.normals), testing::SizeIs(6));
    EXPECT_THAT(values<glm::vec3>(scene, mesh.normals), testing::Each(glm::vec3(0, 0, 1)));
    EXPECT_THAT(values<glm::vec4>(scene, mesh.tangents), testing::SizeIs(6));
}

TEST(GltfMesh, ZeroNormalsAreRecomputedFromTriangles) {
    SceneFile file;
    const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<glm::vec3> normals{{0, 0, 0}, {0, 2, 0}, {nan, 0, 0}};
    const int normal = file.accessor(file.view(normals), Component::Float, "VEC3", 3);
    const ImportedScene scene =
        scene_of(file, primitive(attribute("POSITION", at) + "," + attribute("NORMAL", normal)));
    EXPECT_THAT(values<glm::vec3>(scene, named<Geometry>(scene, "it").normals),
                ElementsAre(glm::vec3(0, 0, 1), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)));
    EXPECT_TRUE(has_notice(scene, "2 normals"));
}

}  // namespace
}  // namespace tessera::import
