#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "mediator/frame/image.h"
#include "mediator/picture/picture_limits.h"

namespace tessera::picture {

// A Radiance picture (.hdr, .pic; format 32-bit_rle_rgbe, rows from the top): three linear components. At
// most MaxPicturePixels. Throws Error{NotFound} without such a file and Error{InvalidInput}
// when it is damaged, truncated or too large. Not by stb_image 2.27, which never returns from a
// truncated run. Source: Ward, "Real Pixels", Graphics Gems II (1991), and its reference reader.
frame::Image read_hdr(const std::string& path);

// The same from memory; the message does not name the file.
frame::Image decode_hdr(std::span<const std::byte> bytes, const PictureLimits& limits = {});

// Whether these are the first bytes of a Radiance picture.
bool is_hdr(std::span<const std::byte> bytes);

}  // namespace tessera::picture
