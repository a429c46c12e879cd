#ifndef TESSERA_MEDIATOR_SHADING_SCALING_H
#define TESSERA_MEDIATOR_SHADING_SCALING_H

#include "mediator/shading/maths.h"

// Lengths and directions in scenes so tiny or huge that squares over- or underflow. Doubles are slow or
// missing on devices; scaling by powers of two is exact.
SHADING_BEGIN

// The exponent of the power of two that brings x > 0 into [1, 2), biased as in a float; towards the ends of
// the range of floats, as near as it goes.
inline uint unit_exponent(float x) {
    const uint exponent = (float_bits(x) >> 23u) & 255u;
    return 254u - min(max(exponent, 1u), 253u);
}
inline float unit_scale(float x) {
    return float_from_bits(unit_exponent(x) << 23u);
}

// The largest component of a vector without NaN.
inline float extent_of(vec3 v) {
    const vec3 sizes = abs(v);
    return max(max(sizes.x, sizes.y), sizes.z);
}

// Unit vector; `otherwise` if v has no direction or is not finite.
inline vec3 direction_of(vec3 v, vec3 otherwise) {
    const float extent = extent_of(v);
    if (!(extent > 0.0f) || !is_finite(extent)) return otherwise;
    const vec3 scaled = v * unit_scale(extent);
    return scaled * (1.0f / sqrt(dot(scaled, scaled)));
}

// A vector as unit direction and length. Both 0 if it has no direction or is not finite.
struct DirectionAndDistance {
    vec3 direction;
    float distance;
};

inline DirectionAndDistance direction_and_distance(vec3 v) {
    const float extent = extent_of(v);
    if (!(extent > 0.0f) || !is_finite(extent)) return DirectionAndDistance(vec3(0.0f), 0.0f);
    const uint exponent = unit_exponent(extent);
    const vec3 scaled = v * float_from_bits(exponent << 23u);
    const float scaled_length = sqrt(dot(scaled, scaled));
    return DirectionAndDistance(scaled * (1.0f / scaled_length),
                                scaled_length * float_from_bits((254u - exponent) << 23u));
}

SHADING_END

#endif
