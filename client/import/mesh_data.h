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
    void add(const Bounds& other, const glm::dmat4& transform);  // its eight corners
};

// Indexed triangles on their way into the scene. Optional arrays are empty or have one element per vertex.
struct MeshData {
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec4> tangents, colors;
    std::vector<glm::vec2> tex_coords, tex_coords_1;
    std::vector<std::uint32_t> indices;  // three per triangle
    std::vector<std::uint32_t>
        origins;  // optional: a number that goes with each vertex, however they are split
};

// Triangles of a strip or a fan in glTF's winding; fewer than three vertices give none.
std::vector<std::uint32_t> triangles_of_strip(std::span<const std::uint32_t> vertices);
std::vector<std::uint32_t> triangles_of_fan(std::span<const std::uint32_t> vertices);

// Throws Error{InvalidInput} when triangles cannot be drawn: indices out of range, positions not finite, no
// triangle. Optional arrays of the wrong length or with values that are not finite are dropped, normals
// without length are made from the triangles; each such repair is one phrase in the result.
std::vector<std::string> check_and_repair(MeshData& mesh);

std::uint64_t count_degenerate(const MeshData& mesh);  // without area, or with a vertex used twice
Bounds bounds_of(const MeshData& mesh);

// Three vertices of its own per triangle, with the triangle's normal: glTF's look of a mesh without normals.
void make_flat(MeshData& mesh);

// Tangents along u from one set of texture coordinates and normals, both present. Vertices shared by
// triangles of either handedness (mirrored texture) are split. Where the texture has no direction any tangent
// is chosen.
void generate_tangents(MeshData& mesh, std::uint32_t set = 0);

}  // namespace tessera::import
