#pragma once

#include <glm/vec2.hpp>
#include <optional>

#include "mediator/display/surface.h"
#include "mediator/view/view.h"

// A projector as an inverse pinhole camera.
namespace tessera::display {

struct Projector {
    glm::dvec3 position{0.0}, look_at{0.0, 0.0, -1.0}, up{0.0, 1.0, 0.0};
    double horizontal_fov = 0.8;  // radians
    // Lens shift right and up, as a fraction of the picture's width and height.
    glm::dvec2 shift{0.0};
};

// Its frustum in display space. Throws Error{InvalidInput} when its direction is null or along `up`.
view::CameraPose pose(const Projector& projector, double aspect_ratio);

// The ray direction through (u, v) of its picture, from the top left; not of unit length.
glm::dvec3 ray(const view::CameraPose& projector, double u, double v);

// The inverse: the (u, v) in its picture that projects to `point`; outside of the picture beyond [0, 1]. Empty for
// points that are not in front of the lens.
std::optional<glm::dvec2> image_coordinates(const view::CameraPose& projector, const glm::dvec3& point);

}  // namespace tessera::display
