#pragma once

#include <cstddef>
#include <span>

#include "mediator/base/error.h"
#include "mediator/frame/image.h"

namespace tessera::picture {

// Decodes a PNG of 8 or 16 bits to [0, 1] without conversion: 1 component for greyscale, 3 for others (palettes are
// expanded); no alpha, no gamma. InvalidInput: not a PNG, damaged, or more than 16384 pixels per side.
Expected<frame::Image> read_png(std::span<const std::byte> bytes);

}  // namespace tessera::picture
