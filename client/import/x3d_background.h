#pragma once

#include "client/import/scene_builder.h"
#include "client/import/x3d_document.h"

namespace tessera::import {

// A Background's sky and ground as light from infinitely far: one colour, or bands of colour as a small
// environment map of 256 rows (0.7 degrees each). Pictures around the scene are not read.
scene::Background read_background(X3dDocument& document, pugi::xml_node node, SceneBuilder& builder);

}  // namespace tessera::import
