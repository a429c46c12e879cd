#pragma once

#include <cstdint>
#include <span>

#include "mediator/view/view.h"

namespace tessera::picture {

// One eye's picture: planes in raster order.
struct EyeView {
    std::uint32_t width = 0, height = 0;
    std::span<const float> red, green, blue;
    std::span<const float> depth;  // along the view's axis; +inf where nothing is hit
    view::CameraPose camera;       // of the whole picture, in the same space for both eyes
};

struct StereoDifference {
    double mean = 0.0;    // of |l - r| / (l + r + 2e) over the luminances of pixels that both eyes see
    double shared = 0.0;  // fraction of the left eye's surface pixels that the right eye sees as well
};

// Consistency of two eyes: every surface point of the left picture is projected into the right one, which is
// interpolated bilinearly; points that are hidden there (depth differs by more than 1 %) or outside are ignored. 0 =
// equal radiance everywhere. Highlights and reflections differ between the eyes by nature; noise and filters must not.
// e = 1e-3 of the left picture's mean luminance keeps differences in black from counting.
StereoDifference stereo_difference(const EyeView& left, const EyeView& right);

}  // namespace tessera::picture
