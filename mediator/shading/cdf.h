#ifndef TESSERA_MEDIATOR_SHADING_CDF_H
#define TESSERA_MEDIATOR_SHADING_CDF_H

#include "mediator/shading/maths.h"
#include "mediator/shading/records.h"

// Sampling of discrete distributions by their cumulative sums, which end at 1.
SHADING_BEGIN

// Index, relative to `first`, of the first value above u; the last one if there is none by rounding.
inline uint first_cdf_above(FloatArray cdf, uint first, uint count, float u) {
    uint low = 0u;
    uint high = count;
    while (low < high) {
        const uint mid = low + (high - low) / 2u;
        if (cdf.items[first + mid] > u) {
            high = mid;
        } else {
            low = mid + 1u;
        }
    }
    return min(low, count - 1u);
}

inline float probability_of(FloatArray cdf, uint first, uint index) {
    return cdf.items[first + index] - (index == 0u ? 0.0f : cdf.items[first + index - 1u]);
}

struct Choice {
    uint index;
    float rest;  // u rescaled to [0, 1)
};

inline Choice choose(FloatArray cdf, uint first, uint count, float u) {
    const uint index = first_cdf_above(cdf, first, count, u);
    const float low = index == 0u ? 0.0f : cdf.items[first + index - 1u];
    const float width = cdf.items[first + index] - low;
    const float rest = width > 0.0f ? (u - low) / width : 0.5f;
    return Choice(index, lesser_of(greater_of(rest, 0.0f), 0.99999994f));
}

SHADING_END

#endif
