#include "client/import/tangents.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "tests/import/inspect.h"

// Generated tangents against those that Blender 3.4.1 wrote (MikkTSpace), and where they are hard to define.
namespace tessera::import {
namespace {

using scene::Geometry;

MeshData mesh_of(const ImportedScene& scene, const Geometry& geometry) {
    MeshData mesh;
    mesh.positions = values<glm::vec3>(scene, geometry.positions);
    mesh.normals = values<glm::vec3>(scene, geometry.normals);
    mesh.tex_coords = values<glm::vec2>(scene, geometry.tex_coords);
    mesh.tangents = values<glm::vec4>(scene, geometry.tangents);
    mesh.indices = values<std::uint32_t>(scene, geometry.indices);
    return mesh;
}

double degrees_between(const glm::vec4& a, const glm::vec4& b) {
    const glm::dvec3 x(a), y(b);
    return glm::degrees(std::atan2(glm::length(glm::cross(x, y)), glm::dot(x, y)));
}

// recorded/make_tangents.py made the file.
TEST(Tangents, AreThoseOfBlender) {
    const ImportedScene scene = loaded(TESSERA_RECORDED "/mikktspace.glb");
    ASSERT_EQ(all<Geometry>(scene).size(), 5u);
    for (const Geometry* geometry : all<Geometry>(scene)) {
        const MeshData theirs = mesh_of(scene, *geometry);
        ASSERT_EQ(theirs.tangents.size(), theirs.positions.size()) << geometry->name;
        MeshData ours = theirs;
        ours.tangents.clear();
        generate_tangents(ours);
        ASSERT_EQ(ours.indices.size(), theirs.indices.size());
        double worst = 0.0;
        for (std::size_t i = 0; i < ours.indices.size(); ++i) {
            const glm::vec4 found = ours.tangents[ours.indices[i]],
                            expected = theirs.tangents[theirs.indices[i]];
            EXPECT_EQ(found.w, expected.w) << geometry->name << " " << i;
            worst = std::max(worst, degrees_between(found, expected));
        }
        EXPECT_LT(worst, 0.1) << geometry->name;
    }
}

// Three triangles around a corner of 20, 40 and 120 degrees: not their number counts, but their angles.
TEST(Tangents, AreWeightedByAngles) {
    MeshData mesh;
    const std::vector<double> angles{0.0, 20.0, 60.0, 180.0};
    glm::dvec2 expected(0.0);
    mesh.positions.push_back({0, 0, 0});
    mesh.tex_coords.push_back({0, 0});
    for (const double angle : angles) {
        const double radians = glm::radians(angle);
        mesh.positions.push_back({float(std::cos(radians)), float(std::sin(radians)), 0.0f});
    }
    // A texture that is turned from triangle to triangle: the directions of u differ.
    for (const double angle : {0.0, 50.0, 110.0, 150.0}) {
        const double radians = glm::radians(angle);
        mesh.tex_coords.push_back({float(std::cos(radians)), -float(std::sin(radians))});
    }
    mesh.normals.assign(mesh.positions.size(), {0, 0, 1});
    for (std::uint32_t i = 0; i < 3; ++i) {
        mesh.indices.insert(mesh.indices.end(), {0, i + 1, i + 2});
        const glm::dvec2 p1(mesh.positions[i + 1]), p2(mesh.positions[i + 2]), t1(mesh.tex_coords[i + 1]),
            t2(mesh.tex_coords[i + 2]);
        const glm::dvec2 u = (p1 * t2.y - p2 * t1.y) / (t1.x * t2.y - t2.x * t1.y);
        expected += glm::normalize(u) * (angles[i + 1] - angles[i]);
    }
    generate_tangents(mesh);
    expected = glm::normalize(expected);
    EXPECT_LT(degrees_between(mesh.tangents[0], glm::vec4(float(expected.x), float(expected.y), 0, 1)), 1e-4);
    EXPECT_EQ(mesh.positions.size(), 5u) << "nothing is split";
}

// Two triangles that touch in a vertex only do not share its tangent.
TEST(Tangents, AreNotSharedWithoutAnEdge) {
    MeshData mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
    mesh.tex_coords = {{0, 0}, {1, 0}, {0, -1}, {1, 0}, {0, -1}};
    mesh.normals.assign(5, {0, 0, 1});
    mesh.indices = {0, 1, 2, 0, 3, 4};
    generate_tangents(mesh);
    EXPECT_EQ(mesh.positions.size(), 6u);
    EXPECT_EQ(mesh.tangents[mesh.indices[0]], glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(mesh.tangents[mesh.indices[3]], glm::vec4(-1, 0, 0, 1));
}

// Without texture coordinates of any area, with zero area in space, at extreme scales: finite, of unit length, at a
// right angle to the normal.
TEST(Tangents, ExistWhereTheMappingHasNoArea) {
    for (const float scale : {1e-18f, 1.0f, 1e18f}) {
        MeshData mesh;
        mesh.positions = {{0, 0, 0}, {scale, 0, 0}, {0, scale, 0}, {scale, scale, 0}, {2 * scale, 0, 0}};
        mesh.tex_coords = {{0, 0}, {1, 0}, {0, -1}, {0.5f, -0.5f}, {7, 7}};
        mesh.normals.assign(5, {0, 0, 1});
        mesh.indices = {0, 1, 2, 2, 1, 3, 1, 1, 4, 4, 4, 4};
        generate_tangents(mesh);
        ASSERT_EQ(mesh.tangents.size(), mesh.positions.size());
        for (const glm::vec4& tangent : mesh.tangents) {
            EXPECT_NEAR(glm::length(glm::vec3(tangent)), 1.0f, 1e-6f) << scale;
            EXPECT_EQ(tangent.z, 0.0f) << scale;
        }
        // The second triangle's texture coordinates lie on a line: it has its neighbour's.
        EXPECT_EQ(mesh.tangents[mesh.indices[3]], mesh.tangents[mesh.indices[2]]) << scale;
    }
}

}  // namespace
}  // namespace tessera::import
