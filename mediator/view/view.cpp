#include "mediator/view/view.h"

#include <cmath>

namespace tessera::view {

std::string_view renderer_name(Renderer renderer) {
    switch (renderer) {
        case Renderer::PathTracing:
            return "path";
        case Renderer::Whitted:
            return "whitted";
        case Renderer::Raster:
            return "raster";
    }
    return "unknown";
}

CameraPose perspective(const glm::dmat4& world_from_camera, double vertical_fov, double aspect_ratio) {
    const double top = std::tan(0.5 * vertical_fov);
    return {.world_from_camera = world_from_camera,
            .left = -top * aspect_ratio,
            .right = top * aspect_ratio,
            .bottom = -top,
            .top = top};
}

}  // namespace tessera::view
