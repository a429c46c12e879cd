#pragma once

#include "client/import/mesh_data.h"

namespace tessera::import {

// Two indices per segment: from pairs of vertices, from a line strip, and from a line loop.
std::vector<std::uint32_t> segments_of_pairs(std::span<const std::uint32_t> vertices);
std::vector<std::uint32_t> segments_of_strip(std::span<const std::uint32_t> vertices);
std::vector<std::uint32_t> segments_of_loop(std::span<const std::uint32_t> vertices);

// Converts points (one index each) to octahedra and segments (two indices) to three-sided prisms, as rays do
// not hit points and lines. The radius is 0.2 % of the mesh's diagonal, or 1 cm if that is 0. Colours,
// texture coordinates and origins are copied from the vertices; no normals (flat shading). Throws
// Error{InvalidInput} for an index out of range, and for too many points or segments.
MeshData point_octahedra(const MeshData& points);
MeshData line_tubes(const MeshData& segments);

}  // namespace tessera::import
