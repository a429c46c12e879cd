#pragma once

#include <glm/mat4x4.hpp>

#include "client/import/mesh_data.h"

namespace tessera::import {

// Margin around the bounds, as a fraction of the picture's height or width.
inline constexpr double FramingMargin = 0.04;

// The rigid pose of a camera that sees all of `bounds` from the front right and above, at the least distance:
// the projected corners are centred and fill the height or the width of a picture of this aspect ratio (width
// / height), except for the margin. Empty bounds count as a box of 1 m at the origin, a single point as a box
// of 1 m around it.
glm::dmat4 framing_pose(Bounds bounds, double vertical_fov, double aspect_ratio);

}  // namespace tessera::import
