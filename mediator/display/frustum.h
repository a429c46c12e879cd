#pragma once

#include <span>

#include "mediator/display/display.h"

namespace tessera::display {

// The eyes whose views an output in this mode needs.
std::span<const view::Eye> eyes(Stereo stereo);

// In display space. `separation` in metres.
glm::dvec3 eye_position(const Head& head, view::Eye eye, double separation);

// The off-axis frustum of an output for one eye, in display space: the camera is at the eye and looks along the
// normal of the projection plane; its edges are the bounding box of the hull at distance 1. Points on a flat wall do
// not move on it when the eye moves.
//
// With `zero_parallax` d > 0 a virtual screen at distance d from the head along the plane's normal is used
// (scaled about the head): points at that distance have no parallax, and the picture from between the eyes is
// unchanged. Throws Error{InvalidInput} when the eye is not in front of the plane and of all of the hull.
view::CameraPose frustum(const ProjectionPlane& plane, const Head& head, view::Eye eye, double separation,
                         double zero_parallax);

// The frustum of the real screen that shows the same picture: with zero parallax at d instead of at the screen's distance
// D the screen is scaled by d / D about the head, which equals an eye separation scaled by D / d.
view::CameraPose screen_pose(const ProjectionPlane& plane, const Head& head, view::Eye eye, double separation,
                             double zero_parallax);

// The same camera in the world: `world_from_camera` of the scene camera that carries the display, rigid.
view::CameraPose in_world(const view::CameraPose& in_display, const glm::dmat4& world_from_display,
                          double units_per_metre);

}  // namespace tessera::display
