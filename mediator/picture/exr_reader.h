#pragma once

#include <string>
#include <vector>

#include "mediator/base/rect.h"
#include "mediator/frame/image.h"

namespace tessera::picture {

// The part of a picture that a file holds, and where it lies in the whole.
struct Picture {
    frame::Image image;
    Rect window;
};

// One layer of an OpenEXR file, scan lines or tiles (of the finest level), half, float or integer, as floats;
// layer "" is the channels without a layer's name. Components come as R G B where the layer has these three
// (A is left out), else as X Y Z, else every channel of the layer in the order of its name. At most
// MaxPicturePixels (exr_header.h). Throws Error{NotFound} without such a file, Error{InvalidInput} when it is
// damaged, too large or has no such layer (the message lists those it has).
Picture read_exr(const std::string& path, const std::string& layer = "");

}  // namespace tessera::picture
