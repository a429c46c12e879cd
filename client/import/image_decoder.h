#pragma once

#include <span>

#include "mediator/base/error.h"
#include "mediator/picture/png_reader.h"

namespace tessera::import {

using DecodedImage = picture::RgbaImage;

// PNG, JPEG, BMP, TGA or Radiance (converted to sRGB, 1 is the brightest). Before anything is allocated, the size in the header is checked against the limits
// and against the number of bytes available. InvalidInput says what is wrong.
Expected<DecodedImage> decode_image(std::span<const unsigned char> bytes);

}  // namespace tessera::import
