#pragma once

#include <optional>

#include "mediator/frame/image.h"
#include "mediator/view/display_transform.h"

namespace tessera::picture {

// The exposure in EV at which the geometric mean of the luminance is middle grey, 0.18 (Reinhard et al. 2002,
// equation 1), but at most that at which a fifth of the pixels is brighter than 0.8, where view transforms
// begin to compress: a white floor before a dark backdrop must not burn out. The darkest tenth of the lit
// pixels and the brightest twentieth do not count for the mean: an unlit corner and a lamp in the picture say
// little about what is to be seen. Nothing if no pixel is lit. `image` has 3
// components or 4, of which the last is alpha: what is transparent does not count.
std::optional<double> measured_exposure(const frame::Image& image);

// With an exposure: its own, else that of the image, else 0.
view::DisplayTransform with_exposure(view::DisplayTransform transform, const frame::Image& image);

}  // namespace tessera::picture
