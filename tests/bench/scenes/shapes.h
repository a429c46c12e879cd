#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

// Triangles of simple shapes, counter-clockwise seen from outside. Metres.
namespace tessera::tools::bench {

struct Mesh {
    std::vector<glm::vec3> positions, normals;  // normals: empty, or one per position
    std::vector<std::uint32_t> indices;
};

// a, b, c, d around; faces the side from which they run counter-clockwise.
Mesh quad(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d);

// Its bottom is at y = base; rotated by `angle` (radians) about y.
Mesh block(glm::vec3 base_centre, glm::vec3 size, float angle);

// Smooth normals; `rings` from pole to pole, twice as many around.
Mesh sphere(glm::vec3 centre, float radius, std::uint32_t rings);

// Flat bars in the plane y = height, along x and along z, over a square of the given edge around the y axis;
// `bars` in each direction, each `width` wide.
Mesh grid(float height, float edge, std::uint32_t bars, float width);

void append(Mesh& mesh, const Mesh& more);

}  // namespace tessera::tools::bench
