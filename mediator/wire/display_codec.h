#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/display/display.h"

namespace tessera::wire {

// The blob that describes a display. Decoding takes anything: what is malformed is an Error{InvalidInput};
// what is decoded may still be no display that can be shown (master/display/display_check.h).
std::vector<std::byte> encode(const display::Display& display);
Expected<display::Display> decode_display(std::span<const std::byte> bytes);

}  // namespace tessera::wire
