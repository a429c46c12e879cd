#pragma once

#include <span>
#include <string_view>

#include "mediator/backend/backend.h"

namespace tessera::backend {

// The back-ends that were built, best first (defined in backends/catalog.cpp).
std::span<const BackendEntry> catalog();

// Throws Error{InvalidInput} with the names there are.
const BackendEntry& find_backend(std::string_view name);

}  // namespace tessera::backend
