#pragma once

#include <cstddef>
#include <vector>

#include "mediator/frame/image.h"

namespace tessera::picture {

enum class FileFormat { Png, Jpeg, Exr };

// A picture file in memory. `image`: 3 components, linear Rec. 709, or 4 with premultiplied alpha. PNG and
// JPEG are tone-mapped (tone_map.h) to 8-bit sRGB; PNG keeps alpha, straight as the format wants it, JPEG
// shows it over black. EXR is linear float, alpha premultiplied. Throws Error{Io}.
std::vector<std::byte> encode_picture(const frame::Image& image, FileFormat format);

}  // namespace tessera::picture
