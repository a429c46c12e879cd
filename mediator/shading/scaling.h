#ifndef TESSERA_MEDIATOR_SHADING_SCALING_H
#define TESSERA_MEDIATOR_SHADING_SCALING_H

#include "mediator/shading/maths.h"

// Lengths and directions of scenes so tiny or so huge that squares leave the range of floats. Devices are
// slow at doubles or have none; scaling by powers of two costs no bits.
SHADING_BEGIN

// The power of two that brings x > 0 into [1, 2); towards the ends of the range of floats, as near as it
// goes.
inline float unit_scale(float x) {
    const uint exponent = (float_bits(x) >> 23u) & 255u;
    return float_from_bits((254u - min(max(exponent, 1u), 253u)) << 23u);
}

// A vector as its direction, of unit length, and how far it reaches. Both 0 where it has none or is not
// finite.
struct Measured {
    vec3 direction;
    float distance;
};

inline Measured measure(vec3 v) {
    Measured result = Measured(vec3(0.0f), 0.0f);
    const float size = largest(abs(v));
    if (!(size > 0.0f) || !is_finite(size)) return result;
    const float scale = unit_scale(size);
    const vec3 scaled = v * scale;
    const float scaled_length = sqrt(dot(scaled, scaled));
    result.direction = scaled / scaled_length;
    result.distance = scaled_length / scale;
    return result;
}

inline vec3 direction_of(vec3 v, vec3 otherwise) {
    const Measured measured = measure(v);
    return measured.distance > 0.0f ? measured.direction : otherwise;
}

SHADING_END

#endif
