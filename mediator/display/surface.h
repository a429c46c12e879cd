#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <variant>

#include "mediator/display/display.h"

// Screens as geometry, in display space. A position on a screen is (u, v) as in its picture: u from 0 at the left to 1
// at the right, v from 0 at the top to 1 at the bottom, as seen by viewers.
namespace tessera::display {

// A flat rectangle: its lower left corner and the edges from there.
struct Wall {
    glm::dvec3 corner{-1.0, -1.0, -1.0}, across{2.0, 0.0, 0.0}, upward{0.0, 2.0, 0.0};
};

// A part of an upright cylinder. Angles in radians, seen from above: 0 is towards -z, positive to the right.
// Heights are above the centre.
struct Cylinder {
    glm::dvec3 centre{0.0};
    double radius = 1.0, from = -0.5, to = 0.5, bottom = -1.0, top = 1.0;
};

// A part of a sphere: azimuth as of the cylinder, elevation above the horizon; then rotated about the x axis
// through the centre by `tilt`, zenith forward.
struct Dome {
    glm::dvec3 centre{0.0};
    double radius = 1.0, from = -0.5, to = 0.5, bottom = 0.0, top = 0.5, tilt = 0.0;
};

using Screen = std::variant<Wall, Cylinder, Dome>;

// From measured corners; the fourth is only checked. Deviations of up to half a degree from right angles (9 mm in 1 m:
// measurement errors) are corrected. Throws Error{InvalidInput} when the corners cross, do not form a rectangle, or
// enclose no area.
Wall wall(const glm::dvec3& lower_left, const glm::dvec3& lower_right, const glm::dvec3& upper_left,
          const std::optional<glm::dvec3>& upper_right = {});

// Straight ahead of the display's origin: the rectangle that a camera with this vertical field of view (radians) sees
// at that distance.
Wall wall_in_view(double vertical_fov, double aspect_ratio, double distance);

glm::dvec3 point(const Wall& wall, double u, double v);
glm::dvec3 point(const Screen& screen, double u, double v);

// Intersection of a ray with the screen or its continuation; of two the one nearer to the screen's centre.
std::optional<glm::dvec3> hit(const Screen& screen, const glm::dvec3& origin, const glm::dvec3& direction);

// A part of the wall, [left, right] x [bottom, top] as fractions from the lower left. Parts that share an edge have
// bit-identical corners there, and so do their pictures.
struct Part {
    double left = 0.0, right = 1.0, bottom = 0.0, top = 1.0;
};
ProjectionPlane projection_plane(const Wall& wall, const Part& part = {});

}  // namespace tessera::display
