#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// Gaussian blur of the radiance, cut at 3 sigma: the baseline, not edge-preserving.
FilterEntry gauss_entry();

}  // namespace tessera::filter
