#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "mediator/shading/layout.h"
#include "mediator/view/view.h"

namespace tessera::backend {

// The view as the kernels read it; the camera is relative to the render origin. The caller sets the address of the
// camera keys.
shading::View make_view(const view::View& view, const glm::dvec3& render_origin);

// The motion keys of a camera; empty if it does not move.
std::vector<shading::Affine3x4> camera_keys(const view::CameraPose& camera, const glm::dvec3& render_origin);

}  // namespace tessera::backend
