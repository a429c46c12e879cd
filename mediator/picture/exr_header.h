#pragma once

#include <cstdint>
#include <string>

#include "mediator/base/rect.h"

namespace tessera::picture {

inline constexpr std::int64_t MaxPicturePixels = std::int64_t{64} << 20;

// Looks through the header of an OpenEXR file before OpenEXR does, which allocates by what a header claims:
// one part, scan lines or tiles; every attribute inside the file; data window and tiles not too large.
// Returns the data window. Throws Error{InvalidInput} that does not name the file. Source: "OpenEXR File
// Layout", openexr.com.
Rect checked_exr_window(const std::string& path);

}  // namespace tessera::picture
