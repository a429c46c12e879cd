#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/display/display.h"

namespace tessera::wire {

// Codec of the blob that describes a display. Decoding accepts arbitrary bytes: malformed ones are an
// Error{InvalidInput}; a decoded display may still be invalid (master/display/display_check.h).
std::vector<std::byte> encode(const display::Display& display);
Expected<display::Display> decode_display(std::span<const std::byte> bytes);

}  // namespace tessera::wire
