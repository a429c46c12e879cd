#pragma once

#include <optional>

#include "mediator/frame/image.h"
#include "mediator/view/display_transform.h"

namespace tessera::picture {

// Automatic exposure in EV: maps the geometric mean of the luminance to middle grey, 0.18 (Reinhard et al. 2002,
// equation 1), but at most a fifth of the pixels to more than 0.8, where view transforms start to compress, so that a
// white floor in front of a dark backdrop is not overexposed. The mean leaves out the darkest tenth of the lit pixels
// and the brightest twentieth (dark corners, visible lamps). Empty if no pixel is lit. `image` has 3 components, or 4
// with alpha; transparent pixels are ignored.
std::optional<double> measured_exposure(const frame::Image& image);

// Sets the exposure, if there is none, to that of the image, else 0.
view::DisplayTransform with_exposure(view::DisplayTransform transform, const frame::Image& image);

}  // namespace tessera::picture
