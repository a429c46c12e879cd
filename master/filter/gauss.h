#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// Gaussian blur of the radiance, cut at 3 sigma: the baseline that sees no edges.
FilterEntry gauss_entry();

}  // namespace tessera::filter
