#include "backends/embree/camera.h"

#include "mediator/shading/sampling.h"

namespace tessera::embree {

Camera::Camera(const view::View& view, const glm::dvec3& render_origin)
    : pose_(view.camera), filter_(view.pixel_filter), width_(view.width), height_(view.height) {
    const glm::dmat4& m = view.camera.world_from_camera;
    eye_ = glm::vec3(glm::dvec3(m[3]) - render_origin);
    right_ = glm::vec3(m[0]);
    up_ = glm::vec3(m[1]);
    forward_ = -glm::vec3(m[2]);
}

Ray Camera::ray(std::uint32_t x, std::uint32_t y, const glm::vec2& u) const {
    const float radius = filter_.radius;
    glm::vec2 offset = radius * (2.0f * u - 1.0f);
    if (filter_.kind == view::PixelFilterKind::Gaussian) {
        offset = {shading::gaussian_offset(u.x, radius), shading::gaussian_offset(u.y, radius)};
    } else if (filter_.kind == view::PixelFilterKind::BlackmanHarris) {
        offset = {shading::blackman_harris_offset(u.x, radius), shading::blackman_harris_offset(u.y, radius)};
    }
    // In double: a pixel's place in a picture of 65,536 leaves a float no bits for the place in the pixel.
    const double sx = (double(x) + 0.5 + double(offset.x)) / width_;
    const double sy = (double(y) + 0.5 + double(offset.y)) / height_;
    const auto px = static_cast<float>(pose_.left + (pose_.right - pose_.left) * sx);
    const auto py = static_cast<float>(pose_.top + (pose_.bottom - pose_.top) * sy);
    return {eye_, glm::normalize(forward_ + px * right_ + py * up_)};
}

}  // namespace tessera::embree
