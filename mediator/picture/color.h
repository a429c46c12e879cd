#pragma once

#include <cmath>

namespace tessera::picture {

// Luminance of linear Rec. 709 components.
inline double luminance(double r, double g, double b) {
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

// IEC 61966-2-1, from [0, 1] to [0, 1].
inline double srgb_from_linear(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

}  // namespace tessera::picture
