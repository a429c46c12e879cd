#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mediator/base/error.h"

namespace tessera::import {

struct DecodedImage {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgba;  // rows from the top
};

// PNG, JPEG, BMP, TGA or Radiance (converted to sRGB, 1 is the brightest). Before anything is allocated, the size in the header is checked against the limits
// and against the number of bytes available. InvalidInput says what is wrong.
Expected<DecodedImage> decode_image(std::span<const unsigned char> bytes);

}  // namespace tessera::import
