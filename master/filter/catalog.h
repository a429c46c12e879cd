#pragma once

#include <span>

#include "mediator/filter/filter.h"

namespace tessera::filter {

// Every reconstruction there is, `none` first. One line each; the names are those of --filter.
std::span<const FilterEntry> catalog();

}  // namespace tessera::filter
