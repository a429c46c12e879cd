#pragma once

#include <string>

#include "mediator/frame/image.h"

namespace tessera::picture {

// A Radiance picture (.hdr, .pic): three linear components. At most MaxPicturePixels (exr_reader.h). Throws
// Error{NotFound} without such a file and Error{InvalidInput} when it is damaged or too large for what it is.
frame::Image read_hdr(const std::string& path);

}  // namespace tessera::picture
