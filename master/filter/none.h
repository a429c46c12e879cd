#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// No denoising: the mean of the samples, the baseline that other filters are compared with.
FilterEntry none_entry();

}  // namespace tessera::filter
