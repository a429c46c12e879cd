#pragma once

#include <glm/vec3.hpp>

#include "mediator/shading/layout.h"
#include "mediator/view/view.h"

namespace tessera::backend {

// What the kernels read of a view; the camera relative to the render origin.
shading::View make_view(const view::View& view, const glm::dvec3& render_origin);

}  // namespace tessera::backend
