#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "mediator/shading/layout.h"
#include "mediator/view/view.h"

namespace tessera::backend {

// What the kernels read of a view; the camera relative to the render origin. Where the camera moves, the
// address of its places is for the caller to fill in.
shading::View make_view(const view::View& view, const glm::dvec3& render_origin);

// Where a camera is at the beginning and at each step after it; none where it stands still.
std::vector<shading::Place> camera_places(const view::CameraPose& camera, const glm::dvec3& render_origin);

}  // namespace tessera::backend
