#pragma once

#include <string>
#include <vector>

#include "mediator/base/rect.h"
#include "mediator/frame/image.h"

namespace tessera::picture {

// The pixels of a file, and their window within the whole picture.
struct Picture {
    frame::Image image;
    Rect window;
};

// One layer of an OpenEXR file, scan lines or tiles (of the finest level), half, float or integer, as floats;
// layer "" has the channels without a layer name. Components are R G B if the layer has these (without A), else X Y Z,
// else all channels of the layer, sorted by name. At most
// MaxPicturePixels. Throws Error{NotFound} if there is no such file, Error{InvalidInput} if it is
// damaged, too large or has no such layer (the message lists its layers).
Picture read_exr(const std::string& path, const std::string& layer = "");

}  // namespace tessera::picture
