#pragma once

#include <cstdint>

#include "client/import/mesh_data.h"

namespace tessera::import {

// Computes tangents along u as MikkTSpace does (Mikkelsen 2008, Simulation of Wrinkled Surfaces Revisited), which
// normal maps are baked with, from one set of texture coordinates and the normals, both present. Corners with equal
// position, normal and texture coordinates share a tangent where an edge connects their triangles and both texture
// mappings have the same handedness; it is the mean of the triangles', weighted by their angles. Vertices that get
// several tangents are split. Triangles without texture coordinates of any area take the tangents of their
// neighbours, else an arbitrary one.
void generate_tangents(MeshData& mesh, std::uint32_t set = 0);

}  // namespace tessera::import
