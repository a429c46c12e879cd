#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace tessera::import {

enum class PolygonShape { Convex, Any };

// Twice the area times the normal of the side from which the corners are counter-clockwise (Newell's method).
// For a polygon that is not planar: of its projection.
glm::dvec3 polygon_area(std::span<const glm::vec3> corners);

// Triangulates a polygon: a fan from the first corner, or ear clipping (O(n^2); a fan for more than 10,000
// corners). Returns indices of corners in the winding of the polygon. Always n - 2 triangles for n corners,
// some of them degenerate if the outline crosses itself.
std::vector<std::array<std::uint32_t, 3>> triangles_of_polygon(std::span<const glm::vec3> corners,
                                                               PolygonShape shape);

}  // namespace tessera::import
