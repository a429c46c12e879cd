#pragma once

#include <optional>

#include "client/import/mesh_data.h"
#include "client/import/x3d_document.h"

namespace tessera::import {

// Box, Sphere, Cone and Cylinder with normals and texture coordinates (t up) as X3D lays them; nothing for a
// node of another kind. Round ones have 72 sides and a sphere 36 rings, 5 degrees each: no point lies deeper
// than 0.1 % of the radius below the true surface along a ring, 0.2 % in the middle of a sphere's face.
std::optional<MeshData> read_solid(X3dDocument& document, pugi::xml_node node);

}  // namespace tessera::import
