#pragma once

#include <span>
#include <string_view>

#include "mediator/backend/backend.h"

namespace tessera::backend {

// The back-ends that were built, best first (defined in backends/catalog.cpp).
std::span<const BackendEntry> catalog();

// Throws Error{InvalidInput} with the names there are.
const BackendEntry& find_backend(std::string_view name);

// Whether any of them has a choice of devices.
bool offers_devices();

// `device` as somebody typed it, "" for nothing, together with the back-end. InvalidInput: that one has no
// choice.
Expected<void> check_device(const BackendEntry& entry, std::string_view device);

}  // namespace tessera::backend
