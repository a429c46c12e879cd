#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace tessera::import {

struct MeshPart {
    std::span<const glm::vec3> positions;
    std::span<const std::uint32_t> indices;  // three per triangle
};

// The area of the holes in one part of a mesh, as a fraction of the part's own area: 0 if the parts together are
// closed, 1 for a flat sheet. A hole is bounded by edges that an odd number of triangles share, corners with equal
// positions being one; cracks where edges meet halfway enclose no area.
double open_fraction(std::span<const MeshPart> parts, std::size_t part);

}  // namespace tessera::import
