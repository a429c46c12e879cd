#pragma once

#include <cstdint>
#include <string>

#include "mediator/base/rect.h"

namespace tessera::picture {

inline constexpr std::int64_t MaxPicturePixels = std::int64_t{64} << 20;

// Checks the header of an OpenEXR file before the OpenEXR library reads it, which allocates whatever a header claims:
// one part, scan lines or tiles; all attributes within the file; data window and tiles not too large. Returns the data
// window. Throws Error{InvalidInput}; the message does not name the file. Source: "OpenEXR File Layout", openexr.com.
Rect checked_exr_window(const std::string& path);

}  // namespace tessera::picture
