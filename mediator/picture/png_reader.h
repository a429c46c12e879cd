#pragma once

#include <cstddef>
#include <span>

#include "mediator/base/error.h"
#include "mediator/frame/image.h"

namespace tessera::picture {

// A PNG of 8 or 16 bits as it is stored, from 0 to 1: 1 component of grey pictures, 3 of others (palettes
// become colours); no alpha, no gamma. InvalidInput says what is wrong: not a PNG, damaged, or beyond
// 16384 pixels a side.
Expected<frame::Image> read_png(std::span<const std::byte> bytes);

}  // namespace tessera::picture
