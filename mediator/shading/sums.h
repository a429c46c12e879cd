#ifndef TESSERA_MEDIATOR_SHADING_SUMS_H
#define TESSERA_MEDIATOR_SHADING_SUMS_H

#include "mediator/shading/maths.h"
#include "mediator/shading/records.h"

// Choices by cumulative sums, which end at 1.
SHADING_BEGIN

// Index, from `first` on, of the first sum above u; the last one where rounding leaves none.
inline uint first_above(FloatArray sums, uint first, uint count, float u) {
    uint low = 0u;
    uint high = count;
    while (low < high) {
        const uint middle = low + (high - low) / 2u;
        if (sums.items[first + middle] > u) {
            high = middle;
        } else {
            low = middle + 1u;
        }
    }
    return min(low, count - 1u);
}

inline float probability_of(FloatArray sums, uint first, uint index) {
    return sums.items[first + index] - (index == 0u ? 0.0f : sums.items[first + index - 1u]);
}

struct Choice {
    uint index;
    float rest;  // u stretched back to [0, 1)
};

inline Choice choose(FloatArray sums, uint first, uint count, float u) {
    const uint index = first_above(sums, first, count, u);
    const float low = index == 0u ? 0.0f : sums.items[first + index - 1u];
    const float width = sums.items[first + index] - low;
    const float rest = width > 0.0f ? (u - low) / width : 0.5f;
    return Choice(index, lesser_of(greater_of(rest, 0.0f), 0.99999994f));
}

SHADING_END

#endif
