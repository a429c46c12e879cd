#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// The mean of the samples as it is: what every other filter is measured against.
FilterEntry none_entry();

}  // namespace tessera::filter
