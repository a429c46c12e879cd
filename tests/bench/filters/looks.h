#pragma once

#include "mediator/frame/image.h"

namespace tessera::tools::bench {

double mean_luminance(const frame::Image& picture);

// Fraction of the pixels that stand out of their surroundings in the picture and not in the reference: their luminance
// differs from the median of the 5 x 5 pixels around them by more than 25 % of it plus 1 % of the reference's mean.
double speck_fraction(const frame::Image& picture, const frame::Image& reference);

}  // namespace tessera::tools::bench
