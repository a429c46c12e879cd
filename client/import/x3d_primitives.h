#pragma once

#include <optional>

#include "client/import/mesh_data.h"
#include "client/import/x3d_document.h"

namespace tessera::import {

// Box, Sphere, Cone and Cylinder with normals and X3D's texture coordinates (t up); nothing for other kinds
// of node. 72 sides and, for a sphere, 36 rings, 5 degrees each: the distance to the true surface is at most
// 0.1 % of the radius along a ring, 0.2 % in the centre of a face of a sphere.
std::optional<MeshData> read_primitive(X3dDocument& document, pugi::xml_node node);

}  // namespace tessera::import
