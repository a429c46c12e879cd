#pragma once

#include <glm/vec4.hpp>

#include "mediator/backend/tables/tables.h"

namespace tessera::backend {

// For View::inside: instances of the bodies that the view's eye is in when the shutter opens, by priority
// (shading/bodies.h). Time: that of looking at all triangles of the bodies in whose boxes the eye is.
glm::uvec4 bodies_around(const SceneTables& tables, const shading::View& view);

}  // namespace tessera::backend
