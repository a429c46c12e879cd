#pragma once

#include <span>
#include <string_view>

#include "mediator/backend/backend.h"

namespace tessera::backend {

// The back-ends that were built, best first (defined in backends/catalog.cpp).
std::span<const BackendEntry> catalog();

// Throws Error{InvalidInput} that lists the available names.
const BackendEntry& find_backend(std::string_view name);

// Whether any back-end lets the user choose a device.
bool has_device_choice();

// `device` is what the user gave, "" for nothing. InvalidInput: this back-end has no choice of devices.
Expected<void> check_device(const BackendEntry& entry, std::string_view device);

}  // namespace tessera::backend
