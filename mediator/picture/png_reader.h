#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/frame/image.h"
#include "mediator/picture/picture_limits.h"

namespace tessera::picture {

// Decodes a PNG of 8 or 16 bits to [0, 1] without conversion: 1 component for greyscale, 3 for others (palettes are
// expanded); no alpha, no gamma. InvalidInput: not a PNG, damaged, more than 16384 pixels per side, or more than its
// bytes can hold.
Expected<frame::Image> read_png(std::span<const std::byte> bytes);

struct RgbaImage {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgba;  // rows from the top
};

// Decodes any PNG to eight bits, the upper ones of 16; no gamma. Decompresses no more than its header claims.
Expected<RgbaImage> read_png_rgba(std::span<const std::byte> bytes, const PictureLimits& limits);

// Decodes a PNG of 16 bits without alpha to three components in [0, 1], no gamma; none for any other.
Expected<std::optional<frame::Image>> read_png16(std::span<const std::byte> bytes,
                                                 const PictureLimits& limits);

bool is_png(std::span<const std::byte> bytes);  // whether these are the first bytes of one

}  // namespace tessera::picture
