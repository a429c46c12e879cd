#include "mediator/display/frustum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "mediator/base/error.h"

namespace tessera::display {

std::span<const view::Eye> eyes(Stereo stereo) {
    using enum view::Eye;
    static constexpr std::array<view::Eye, 1> Middle{Mono}, LeftEye{Left}, RightEye{Right};
    static constexpr std::array<view::Eye, 2> Both{Left, Right};
    switch (stereo) {
        case Stereo::Mono:
            return Middle;
        case Stereo::Left:
            return LeftEye;
        case Stereo::Right:
            return RightEye;
        default:
            return Both;
    }
}

glm::dvec3 eye_position(const Head& head, view::Eye eye, double separation) {
    if (eye == view::Eye::Mono) return head.position;
    const double side = eye == view::Eye::Left ? -0.5 : 0.5;
    return head.position + head.orientation * glm::dvec3(side * separation, 0.0, 0.0);
}

view::CameraPose frustum(const ProjectionPlane& plane, const Head& head, view::Eye eye, double separation,
                         double zero_parallax) {
    const glm::dvec3 normal = glm::cross(plane.right, plane.up);
    double scale = 1.0;
    if (zero_parallax > 0.0) {
        const double distance = glm::dot(head.position - plane.origin, normal);
        if (!(distance > 0.0))
            throw Error(ErrorCode::InvalidInput, "the head is not in front of the screen: move it there");
        scale = zero_parallax / distance;
    }
    const glm::dvec3 position = eye_position(head, eye, separation);
    double left = std::numeric_limits<double>::infinity(), bottom = left, right = -left, top = -left;
    for (const glm::dvec3& point : plane.hull) {
        const glm::dvec3 direction = head.position + scale * (point - head.position) - position;
        const double depth = -glm::dot(direction, normal);
        if (!(depth > 0.0))
            throw Error(ErrorCode::InvalidInput, "an eye is not in front of the screen: move the head there");
        const double x = glm::dot(direction, plane.right) / depth, y = glm::dot(direction, plane.up) / depth;
        left = std::min(left, x);
        right = std::max(right, x);
        bottom = std::min(bottom, y);
        top = std::max(top, y);
    }
    if (!(right > left && top > bottom && std::isfinite(right - left) && std::isfinite(top - bottom)))
        throw Error(ErrorCode::InvalidInput, "the screen is not visible from the eye: move the head");
    const glm::dmat4 pose(glm::dvec4(plane.right, 0.0), glm::dvec4(plane.up, 0.0), glm::dvec4(normal, 0.0),
                          glm::dvec4(position, 1.0));
    return {.world_from_camera = pose, .left = left, .right = right, .bottom = bottom, .top = top};
}

view::CameraPose screen_pose(const ProjectionPlane& plane, const Head& head, view::Eye eye, double separation,
                             double zero_parallax) {
    if (zero_parallax > 0.0)
        separation *=
            glm::dot(head.position - plane.origin, glm::cross(plane.right, plane.up)) / zero_parallax;
    return frustum(plane, head, eye, separation, 0.0);
}

view::CameraPose in_world(const view::CameraPose& in_display, const glm::dmat4& world_from_display,
                          double units_per_metre) {
    view::CameraPose camera = in_display;
    glm::dmat4 scaled = in_display.world_from_camera;
    scaled[3] = glm::dvec4(units_per_metre * glm::dvec3(scaled[3]), 1.0);
    camera.world_from_camera = world_from_display * scaled;
    return camera;
}

}  // namespace tessera::display
