#include "mediator/view/view.h"

#include <cmath>

namespace tessera::view {

std::string_view renderer_name(Renderer renderer) {
    return enumerator_name(renderer);
}

CameraPose perspective(const glm::dmat4& world_from_camera, double vertical_fov, double aspect_ratio) {
    const double top = std::tan(0.5 * vertical_fov);
    return {.world_from_camera = world_from_camera,
            .left = -top * aspect_ratio,
            .right = top * aspect_ratio,
            .bottom = -top,
            .top = top};
}

CameraPose pose(const scene::Camera& camera, const glm::dmat4& world_from_camera, double aspect_ratio) {
    CameraPose pose = perspective(world_from_camera, camera.vertical_fov, aspect_ratio);
    if (camera.projection == scene::Projection::Orthographic) {
        pose.top = 0.5 * camera.orthographic_height;
        pose.right = pose.top * aspect_ratio;
        pose.bottom = -pose.top;
        pose.left = -pose.right;
    }
    pose.projection = camera.projection;
    pose.lens_radius = camera.lens_radius;
    pose.focus_distance = camera.focus_distance;
    pose.aperture = camera.aperture;
    return pose;
}

}  // namespace tessera::view
