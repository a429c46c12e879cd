#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// Edge-avoiding a-trous wavelets (Dammertz et al. 2010): a 5 x 5 cubic B-spline whose taps lie 2^i pixels
// apart at level i, each weighted by
//     exp(-|dc|^2 / (2 (sigma_color 2^-i)^2) - |dn|^2 / (2 sigma_normal^2) - |d ln depth|^2 / (2
//     sigma_depth^2))
// c is what the level before left, as c / (c + mean luminance), so that the weight does not depend on the
// exposure and a bright sample is as far away as a white one.
FilterEntry eaw_entry();

}  // namespace tessera::filter
