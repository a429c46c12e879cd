#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace tessera::import {

enum class PolygonShape { Convex, Any };

// Twice the area, along the normal of the side from which the corners go counter-clockwise (Newell's method);
// of a polygon that is not flat, of its shadow.
glm::dvec3 polygon_area(std::span<const glm::vec3> corners);

// Triangles of a polygon by numbers of its corners, in its winding: a fan from the first corner, or by
// cutting ears (O(n^2); a fan, too, of more than 10,000 corners). Of n corners always n - 2, without area
// where the outline crosses itself.
std::vector<std::array<std::uint32_t, 3>> triangles_of_polygon(std::span<const glm::vec3> corners,
                                                               PolygonShape shape);

}  // namespace tessera::import
