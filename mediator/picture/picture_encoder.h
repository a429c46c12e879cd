#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "mediator/frame/image.h"
#include "mediator/picture/custom_view.h"
#include "mediator/view/display_transform.h"

namespace tessera::picture {

enum class FileFormat { Png, Jpeg, Exr };

// A picture file in memory. `image`: 3 components, linear Rec. 709, or 4 with premultiplied alpha. PNG and
// JPEG are 8-bit sRGB by `transform`, whose exposure is measured from the image if it has none, and record the exposure
// in a text chunk or comment. PNG keeps alpha, unpremultiplied as the format requires; JPEG is composited over black.
// EXR is linear float with premultiplied alpha, without the transform. Throws Error{Io}.
std::vector<std::byte> encode_picture(const frame::Image& image, FileFormat format,
                                      const view::DisplayTransform& transform,
                                      const CustomView* custom = nullptr);

// The encoded bytes of a display, 3 per pixel. With `custom` its view replaces the view transform and the sRGB curve; the exposure is
// that of `transform`. `image` has 3 components.
std::vector<std::uint8_t> display_bytes(const frame::Image& image, const view::DisplayTransform& transform,
                                        const CustomView* custom = nullptr);

// "neutral, exposure 1.25 EV", for files and reports.
std::string describe(const view::DisplayTransform& transform, const CustomView* custom = nullptr);

}  // namespace tessera::picture
