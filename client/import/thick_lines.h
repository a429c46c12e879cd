#pragma once

#include "client/import/mesh_data.h"

namespace tessera::import {

// Two indices for each segment: of pairs of vertices, of a line through all of them, and of one that is
// closed.
std::vector<std::uint32_t> segments_of_pairs(std::span<const std::uint32_t> vertices);
std::vector<std::uint32_t> segments_of_strip(std::span<const std::uint32_t> vertices);
std::vector<std::uint32_t> segments_of_loop(std::span<const std::uint32_t> vertices);

// Points (one index each) as octahedra and segments (two) as prisms with three sides, since what has no area
// is not seen by rays: 0.2 % of the mesh's diagonal thick on either side, 1 cm where it has none. Colours,
// texture coordinates and origins are the points' own; flat, without normals. Throws Error{InvalidInput} for
// an index of no vertex, and for too many.
MeshData thick_points(const MeshData& points);
MeshData thick_lines(const MeshData& segments);

}  // namespace tessera::import
