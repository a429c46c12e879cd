#pragma once

#include "mediator/picture/convolution.h"

namespace tessera::picture {

// The feature part of FLIP: per pixel how differently edges and points show in two pictures of luminance in
// [0, 1]; in [0, 1]. Section 4.2 of the paper of 2020.
Plane flip_feature_difference(const Plane& picture, const Plane& reference, double pixels_per_degree);

}  // namespace tessera::picture
