#pragma once

#include <string>

#include "mediator/base/rect.h"
#include "mediator/picture/picture_limits.h"

namespace tessera::picture {

// Checks the header of an OpenEXR file before the OpenEXR library reads it, which allocates whatever a header claims:
// one part, scan lines or tiles; all attributes within the file; data window and tiles not too large, and not larger
// than the bytes of the file can hold with its compression. Returns the data window. Throws Error{InvalidInput}; the
// message does not name the file. Source: "OpenEXR File Layout", openexr.com.
Rect checked_exr_window(const std::string& path, const PictureLimits& limits = {});

}  // namespace tessera::picture
