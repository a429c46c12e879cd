#pragma once

#include <glm/mat4x4.hpp>

#include "client/import/mesh_data.h"

namespace tessera::import {

// How much of a picture's height or width is left free around what is framed.
inline constexpr double FramingMargin = 0.04;

// The rigid pose of a camera that looks from the front right and above at all of `bounds` (a box of 1 m
// around the origin where they are empty, around their one point where they have no size) and is no farther
// away than it has to be: the corners' projections span the whole height or the whole width of a picture of
// this aspect ratio (width / height), but for the margin, and are in its middle.
glm::dmat4 framing_pose(Bounds bounds, double vertical_fov, double aspect_ratio);

}  // namespace tessera::import
