#pragma once

#include "master/filter/pixel/guide.h"

namespace tessera::filter::pixel {

// The filtered quantities: components 0-2 the high-variance light, 3 its variance, 4 alpha if present; and
// the remaining fraction of each pixel's variance (r = sum of squared normalised weights, Schwenk 3.5).
struct Field {
    PaddedPlanes values;
    PaddedPlanes reduction;
    static constexpr std::uint32_t Variance = 3, Alpha = 4;

    void fit(std::uint32_t width, std::uint32_t height, std::uint32_t components) {
        values.fit(width, height, components);
        reduction.fit(width, height, 1);
    }
};

// Kernel widths: standard deviations in pixels, 1 component, 0 outside the picture.
using Widths = PaddedPlanes;

enum class Method { Separable, Brute, ATrous };

}  // namespace tessera::filter::pixel
