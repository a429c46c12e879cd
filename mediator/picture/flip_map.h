#pragma once

#include <array>

#include "mediator/picture/convolution.h"

namespace tessera::picture {

using RgbPlanes = std::array<Plane, 3>;  // linear Rec. 709 in [0, 1]

// FLIP per pixel of two pictures of one size, as a display shows them; in [0, 1].
Plane flip_map(const RgbPlanes& picture, const RgbPlanes& reference);

}  // namespace tessera::picture
