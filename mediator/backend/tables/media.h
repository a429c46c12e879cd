#pragma once

#include <glm/vec4.hpp>

#include "mediator/backend/tables/tables.h"

namespace tessera::backend {

// For View::containing_media: the instances with a medium that contain the camera when the shutter opens, by priority
// (shading/containing_media.h). Tests all triangles of the instances whose bounds contain the camera.
glm::uvec4 media_around(const SceneTables& tables, const shading::View& view);

}  // namespace tessera::backend
