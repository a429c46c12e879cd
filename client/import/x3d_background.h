#pragma once

#include "client/import/scene_builder.h"
#include "client/import/x3d_document.h"

namespace tessera::import {

// A Background's sky and ground as an infinite light: one colour, or a gradient as an environment map of 256
// rows (0.7 degrees each). Background images are not supported.
scene::Background read_background(X3dDocument& document, pugi::xml_node node, SceneBuilder& builder);

}  // namespace tessera::import
