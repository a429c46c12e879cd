#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/frame/image.h"

namespace tessera::import {

struct DecodedImage {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgba;  // rows from the top
};

// PNG, JPEG, BMP or TGA. The size that the header claims is checked against the limits and against the number
// of bytes that must stand behind it, before anything is allocated. InvalidInput says what is wrong.
Expected<DecodedImage> decode_image(std::span<const unsigned char> bytes);

// A Radiance picture (.hdr): three components, linear. Checked likewise.
Expected<frame::Image> decode_hdr(std::span<const unsigned char> bytes);

}  // namespace tessera::import
