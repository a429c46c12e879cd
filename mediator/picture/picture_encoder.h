#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "mediator/frame/image.h"
#include "mediator/view/display_transform.h"

namespace tessera::picture {

enum class FileFormat { Png, Jpeg, Exr };

// A picture file in memory. `image`: 3 components, linear Rec. 709, or 4 with premultiplied alpha. PNG and
// JPEG are 8-bit sRGB by `transform`, whose exposure is measured from the image if it has none, and say in a
// text chunk or comment which exposure that was; PNG keeps alpha, straight as the format wants it, JPEG shows
// it over black. EXR is linear float, alpha premultiplied, whatever the transform. Throws Error{Io}.
std::vector<std::byte> encode_picture(const frame::Image& image, FileFormat format,
                                      const view::DisplayTransform& transform);

// "neutral, exposure 1.25 EV": what the files say, and what reports print.
std::string describe(const view::DisplayTransform& transform);

}  // namespace tessera::picture
