#pragma once

#include <cstdint>
#include <vector>

#include "mediator/frame/image.h"

namespace tessera::picture {

// Photographic tone reproduction (Reinhard et al. 2002, equations 1 to 4): the logarithmic mean of the
// luminance becomes `key`, then L (1 + L / white^2) / (1 + L). Colours keep their ratios.
struct ToneMapping {
    float key = 0.18f;
    float exposure = 0.0f;  // stops, on top
    float white = 0.0f;     // smallest scaled luminance that becomes white; 0 = the picture's largest
};

// 8-bit sRGB (IEC 61966-2-1), 3 bytes a pixel, rows from the top. `image` has 3 components, linear Rec. 709;
// what is not finite or negative counts as black. An all-black picture stays black.
std::vector<std::uint8_t> tone_map(const frame::Image& image, const ToneMapping& mapping = {});

}  // namespace tessera::picture
