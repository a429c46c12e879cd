#include "mediator/display/projector.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "mediator/base/error.h"

namespace tessera::display {

view::CameraPose pose(const Projector& projector, double aspect_ratio) {
    const glm::dvec3 direction = projector.look_at - projector.position;
    const glm::dvec3 side = glm::cross(direction, projector.up);
    if (!(glm::length(direction) > 0.0))
        throw Error(ErrorCode::InvalidInput, "the projector looks at its own position: move look_at");
    // Within a thousandth of a degree of `up` the orientation is undefined.
    if (!(glm::length(side) > 2e-5 * glm::length(direction) * glm::length(projector.up)))
        throw Error(ErrorCode::InvalidInput, "the projector looks along its up direction: give another up");
    const glm::dvec3 back = -glm::normalize(direction), right = glm::normalize(side);
    const double half_width = std::tan(projector.horizontal_fov / 2.0);
    const double half_height = half_width / aspect_ratio;
    const glm::dvec2 moved = 2.0 * projector.shift * glm::dvec2(half_width, half_height);
    return {.world_from_camera = glm::dmat4(glm::dvec4(right, 0.0), glm::dvec4(glm::cross(back, right), 0.0),
                                            glm::dvec4(back, 0.0), glm::dvec4(projector.position, 1.0)),
            .left = moved.x - half_width,
            .right = moved.x + half_width,
            .bottom = moved.y - half_height,
            .top = moved.y + half_height};
}

glm::dvec3 ray(const view::CameraPose& projector, double u, double v) {
    const double x = projector.left + u * (projector.right - projector.left);
    const double y = projector.top + v * (projector.bottom - projector.top);
    return glm::dvec3(projector.world_from_camera * glm::dvec4(x, y, -1.0, 0.0));
}

std::optional<glm::dvec2> image_coordinates(const view::CameraPose& projector, const glm::dvec3& point) {
    const glm::dmat4& axes = projector.world_from_camera;
    const glm::dvec3 direction = point - glm::dvec3(axes[3]);
    const double depth = -glm::dot(direction, glm::dvec3(axes[2]));
    if (!(depth > 0.0)) return std::nullopt;
    const double x = glm::dot(direction, glm::dvec3(axes[0])) / depth,
                 y = glm::dot(direction, glm::dvec3(axes[1])) / depth;
    return glm::dvec2((x - projector.left) / (projector.right - projector.left),
                      (y - projector.top) / (projector.bottom - projector.top));
}

}  // namespace tessera::display
