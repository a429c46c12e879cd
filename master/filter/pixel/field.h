#pragma once

#include "master/filter/pixel/guide.h"

namespace tessera::filter::pixel {

// The filtered quantities: components 0-2 the high-variance light, 3 its variance, 4 alpha if present; and
// the remaining fraction of each pixel's variance (r = sum of squared normalised weights, Schwenk 3.5).
//
// Where counts differ between pixels, samples have the same weight and not pixels: while it is filtered, every
// component is multiplied by the pixel's count w, relative to the largest, and one more component is w itself.
// Filters are linear, so their result divided by its last component is the mean over samples. The variance is
// then that of one sample, which does not depend on the count, and r starts as w: with normalised weights a
// it becomes sum of a^2 w, and the mean's variance is that of one sample times (sum of a^2 w) / (sum of a w)^2
// over the largest count.
struct Field {
    PaddedPlanes values;
    PaddedPlanes reduction;
    bool weighted = false;  // by counts; the last component is w
    static constexpr std::uint32_t Variance = 3, Alpha = 4;

    // `components` with w.
    void fit(std::uint32_t width, std::uint32_t height, std::uint32_t components, bool by_counts) {
        values.fit(width, height, components);
        reduction.fit(width, height, 1);
        weighted = by_counts;
    }
    const float* weight_row(std::uint32_t y) const { return values.row(values.components() - 1, y); }
};

// Kernel widths: standard deviations in pixels, 1 component, 0 outside the picture.
using Widths = PaddedPlanes;

enum class Method { Separable, Brute, ATrous };

}  // namespace tessera::filter::pixel
