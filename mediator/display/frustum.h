#pragma once

#include <span>

#include "mediator/display/display.h"

namespace tessera::display {

// What a picture of an output in this mode needs.
std::span<const view::Eye> eyes(Stereo stereo);

// In display space. `separation` in metres.
glm::dvec3 eye_position(const Head& head, view::Eye eye, double separation);

// The off-axis frustum of an output for one eye, in display space: the camera stands in the eye and looks
// straight at the view plane; edges are the bounding box of the hull at distance 1. The picture of a flat
// wall lies still on the wall wherever the eye is.
//
// With `zero_parallax` d > 0 the screen is thought at distance d from the head along the plane's normal
// (scaled about the head): what is d away has no parallax, and the picture from between the eyes stays as it
// is. Throws Error{InvalidInput} when the eye is not in front of the plane and of all of the hull.
view::CameraPose frustum(const ViewPlane& plane, const Head& head, view::Eye eye, double separation,
                         double zero_parallax);

// Where the screen itself is seen as that picture shows it: with zero parallax at d instead of at the
// screen's distance D the screen is scaled by d / D about the head, which is the same as eyes D / d as far
// apart.
view::CameraPose screen_pose(const ViewPlane& plane, const Head& head, view::Eye eye, double separation,
                             double zero_parallax);

// The same camera in the world: `world_from_camera` of the scene camera that carries the display, rigid.
view::CameraPose in_world(const view::CameraPose& in_display, const glm::dmat4& world_from_display,
                          double units_per_metre);

}  // namespace tessera::display
