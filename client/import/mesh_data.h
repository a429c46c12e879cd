#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace tessera::import {

struct Bounds {
    glm::dvec3 lower{std::numeric_limits<double>::infinity()};
    glm::dvec3 upper{-std::numeric_limits<double>::infinity()};

    bool empty() const { return !(lower.x <= upper.x); }
    void add(const glm::dvec3& point);
    void add(const Bounds& other, const glm::dmat4& transform);  // the eight transformed corners
};

// Indexed triangles during import. Optional arrays are empty or have one element per vertex.
struct MeshData {
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec4> tangents, colors;
    std::vector<glm::vec2> tex_coords, tex_coords_1;
    std::vector<std::uint32_t> indices;  // three per triangle
    std::vector<std::uint32_t>
        origins;  // optional: the original index of each vertex, kept when vertices are split
};

// Triangles of a strip or a fan in glTF's winding; fewer than three vertices give none.
std::vector<std::uint32_t> triangles_of_strip(std::span<const std::uint32_t> vertices);
std::vector<std::uint32_t> triangles_of_fan(std::span<const std::uint32_t> vertices);

// Throws Error{InvalidInput} if the mesh is unusable: indices out of range, positions not finite, no
// triangle. Optional arrays of the wrong length or with values that are not finite are removed, normals of
// length zero are recomputed from the triangles. Returns one line per repair.
std::vector<std::string> check_and_repair(MeshData& mesh);

std::uint64_t count_degenerate(const MeshData& mesh);  // without area, or with a vertex used twice
Bounds bounds_of(const MeshData& mesh);

// Flat shading, as glTF specifies for meshes without normals: three separate vertices per triangle, with its
// normal.
void make_flat(MeshData& mesh);

}  // namespace tessera::import
