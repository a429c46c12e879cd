#pragma once

#include <span>

#include "mediator/filter/filter.h"

namespace tessera::filter {

// All denoisers, `none` first; their names are the values of --filter.
std::span<const FilterEntry> catalog();

}  // namespace tessera::filter
