#pragma once

#include "backends/embree/ray_caster.h"
#include "mediator/view/view.h"

namespace tessera::embree {

// A view's camera, relative to the render origin.
class Camera {
  public:
    Camera(const view::View& view, const glm::dvec3& render_origin);

    // Through a point of the pixel's neighbourhood that u chooses, in proportion to the pixel filter.
    Ray ray(std::uint32_t x, std::uint32_t y, const glm::vec2& u) const;
    // Along the view axis, of a point at `distance` along a ray.
    float depth(const Ray& ray, float distance) const { return distance * glm::dot(ray.direction, forward_); }

  private:
    view::CameraPose pose_;
    view::PixelFilter filter_;
    std::uint32_t width_, height_;
    glm::vec3 eye_{0.0f}, right_{0.0f}, up_{0.0f}, forward_{0.0f};
};

}  // namespace tessera::embree
