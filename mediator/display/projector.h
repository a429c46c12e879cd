#pragma once

#include <glm/vec2.hpp>
#include <optional>

#include "mediator/display/surface.h"
#include "mediator/view/view.h"

// A projector as a pinhole that throws its picture: a camera the other way round.
namespace tessera::display {

struct Projector {
    glm::dvec3 position{0.0}, look_at{0.0, 0.0, -1.0}, up{0.0, 1.0, 0.0};
    double horizontal_fov = 0.8;  // radians
    // By which part of its width and height the lens moves the picture, right and up.
    glm::dvec2 shift{0.0};
};

// Its frustum in display space. Throws Error{InvalidInput} when it looks nowhere or along `up`.
view::CameraPose pose(const Projector& projector, double aspect_ratio);

// The direction of the light of the place (u, v) of its picture, from the top left; not of unit length.
glm::dvec3 ray(const view::CameraPose& projector, double u, double v);

// The inverse: where in the picture the light comes from that meets `point`; beyond [0, 1] it is outside.
// Nothing for what is not in front of the lens.
std::optional<glm::dvec2> place_in_picture(const view::CameraPose& projector, const glm::dvec3& point);

}  // namespace tessera::display
