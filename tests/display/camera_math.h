#pragma once

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mediator/view/view.h"

namespace tessera::display {

// Image coordinates of a point, (u, v) from the top left.
inline glm::dvec2 image_position(const view::CameraPose& camera, const glm::dvec3& point) {
    const glm::dmat4& axes = camera.world_from_camera;
    const glm::dvec3 offset = point - glm::dvec3(axes[3]);
    const double depth = -glm::dot(offset, glm::dvec3(axes[2]));
    return {(glm::dot(offset, glm::dvec3(axes[0])) / depth - camera.left) / (camera.right - camera.left),
            (camera.top - glm::dot(offset, glm::dvec3(axes[1])) / depth) / (camera.top - camera.bottom)};
}

// The direction of the camera ray through (u, v).
inline glm::dvec3 direction_through(const view::CameraPose& camera, const glm::dvec2& uv) {
    const glm::dvec4 inside(camera.left + uv.x * (camera.right - camera.left),
                            camera.top + uv.y * (camera.bottom - camera.top), -1.0, 0.0);
    return glm::normalize(glm::dvec3(camera.world_from_camera * inside));
}

}  // namespace tessera::display
