#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// Edge-avoiding a-trous wavelets (Dammertz et al. 2010): a 5 x 5 cubic B-spline with taps 2^i pixels apart
// at level i, each weighted by
//     exp(-|dc|^2 / (2 (sigma_color 2^-i)^2) - |dn|^2 / (2 sigma_normal^2) - |d ln depth|^2 / (2
//     sigma_depth^2))
// c is the colour after the previous level, compressed as c / (c + mean luminance): weights do not depend on
// the exposure, and very bright samples are not treated as infinitely far away.
FilterEntry eaw_entry();

}  // namespace tessera::filter
