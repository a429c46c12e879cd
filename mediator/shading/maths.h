#ifndef TESSERA_MEDIATOR_SHADING_MATHS_H
#define TESSERA_MEDIATOR_SHADING_MATHS_H

#include "mediator/shading/language.h"

// Elementary functions. Vulkan drivers may be off by 2^-11 (sin, cos) or without bound (pow near 1, atan), so
// these are polynomials, the same in C++ and in GLSL. Coefficients are minimax (Remez), with an error of the
// polynomial itself below 2^-27 of the result. Bounds are against the exact result, in units in the last
// place (ulp), with exactly rounded +, -, * and /; a device that divides to 2.5 ulp, or contracts what is not
// PRECISE, may add as much again. Arguments must be finite; numbers below 2^-126 count as 0.
//
// sqrt is the device's: Vulkan bounds it by 1 / inversesqrt, 4.5 ulp (2 + 2.5), which is of the order of the
// rounding around it, and a correcting step would cost a division.
SHADING_BEGIN

inline constexpr float Pi = 3.14159265358979f;
inline constexpr float InversePi = 0.318309886f;

// As fmax and fmin: NaN is ignored. Written out, because compilers call the library for those.
inline float greater_of(float a, float b) {
    return a > b || is_nan(b) ? a : b;
}
inline float lesser_of(float a, float b) {
    return a < b || is_nan(b) ? a : b;
}
inline vec3 greater_of(vec3 v, float least) {
    return vec3(greater_of(v.x, least), greater_of(v.y, least), greater_of(v.z, least));
}
inline float largest(vec3 v) {
    return greater_of(v.x, greater_of(v.y, v.z));
}

// An angle as the nearest multiple of pi/2 and the remainder, at most pi/4 (plus rounding).
struct ReducedAngle {
    uint quarter;
    float rest;
};

// pi/2 in parts of 11 bits: their products with up to 13 bits are exact (Cody and Waite 1980).
inline ReducedAngle reduce_angle(float angle) {
    PRECISE float turns = floor(angle * 0.636619772f + 0.5f);
    PRECISE float rest = angle - turns * 1.5703125f;
    rest = rest - turns * 4.837512969970703125e-4f;
    rest = rest - turns * 7.5495336204767227173e-8f;
    rest = rest - turns * 2.56334407e-12f;
    return ReducedAngle(uint(int(turns)), rest);
}

inline float sine_near_zero(float x) {
    const float x2 = x * x;
    PRECISE float p = x2 * (-0.166666552f + x2 * (0.00833218824f + x2 * -0.000195180954f));
    p = x + x * p;
    return p;
}
inline float cosine_near_zero(float x) {
    const float x2 = x * x;
    PRECISE float p = x2 * x2 * (0.0416666456f + x2 * (-0.00138873095f + x2 * 2.44323273e-05f));
    p = 1.0f - (0.5f * x2 - p);
    return p;
}

// |angle| <= 10: 2 ulp; <= 1e4: 3 ulp.
inline float sine(float angle) {
    const ReducedAngle reduced = reduce_angle(angle);
    const float even = sine_near_zero(reduced.rest), odd = cosine_near_zero(reduced.rest);
    const float magnitude = (reduced.quarter & 1u) == 0u ? even : odd;
    return (reduced.quarter & 2u) == 0u ? magnitude : -magnitude;
}

// |angle| <= 10: 2 ulp; <= 1e4: 3 ulp.
inline float cosine(float angle) {
    const ReducedAngle reduced = reduce_angle(angle);
    const float even = cosine_near_zero(reduced.rest), odd = sine_near_zero(reduced.rest);
    const float magnitude = (reduced.quarter & 1u) == 0u ? even : odd;
    return ((reduced.quarter + 1u) & 2u) == 0u ? magnitude : -magnitude;
}

// 1 ulp; less than 2^-126: within 2^-149. Too large is infinite.
inline float exponential(float x) {
    if (x > 88.8f) return infinity();
    if (x < -104.0f) return 0.0f;
    PRECISE float twos = floor(x * 1.44269504f + 0.5f);
    PRECISE float r = x - twos * 0.693145751953125f;
    r = r - twos * 1.42860677e-06f;
    const float p =
        0.49999994f + r * (0.166665167f + r * (0.0416681059f + r * (0.00836914219f + r * 0.00138367689f)));
    PRECISE float result = 1.0f + (r + r * r * p);
    // 2^twos in two steps: at the ends one factor alone is no float.
    const int half_twos = int(twos) >> 1;
    result = result * float_from_bits(uint(half_twos + 127) << 23);
    return result * float_from_bits(uint(int(twos) - half_twos + 127) << 23);
}

// Natural logarithm. 1 ulp. For x <= 0: minus infinity.
inline float logarithm(float x) {
    if (!(x >= 1.17549435e-38f)) return -infinity();
    // x = 2^twos m, m from sqrt(1/2) to sqrt(2), whose bits are 3f3504f3 and 3fb504f3.
    const uint bits = float_bits(x) - 0x3f3504f3u;
    const float twos = float(int(bits) >> 23);
    const float f = float_from_bits((bits & 0x7fffffu) + 0x3f3504f3u) - 1.0f;
    float p = 0.142017871f + f * (-0.131602049f + f * (0.127613872f + f * -0.0763419792f));
    p = 0.333333313f + f * (-0.250008196f + f * (0.200012252f + f * (-0.166233584f + f * p)));
    PRECISE float low = twos * 1.42860677e-06f + f * f * (f * p - 0.5f);
    low = twos * 0.693145751953125f + (f + low);
    return low;
}

// x^y for x >= 0. 2 + 2 |y ln x| ulp.
inline float power(float x, float y) {
    return y == 0.0f ? 1.0f : exponential(y * logarithm(x));
}

// The angle of the point (x, y), in [-pi, pi]; 0 at the origin, pi for x < 0 and y = 0 of either sign. 3 ulp.
inline float arc_tangent(float y, float x) {
    const float far = greater_of(abs(x), abs(y)), near = lesser_of(abs(x), abs(y));
    if (!(far > 0.0f)) return 0.0f;
    const float t = near / far, t2 = t * t;
    float p = -0.0839920864f +
              t2 * (0.0578789152f + t2 * (-0.0310936347f + t2 * (0.0108663719f + t2 * -0.00178218167f)));
    p = -0.333332986f + t2 * (0.199985296f + t2 * (-0.142640144f + t2 * (0.109508611f + t2 * p)));
    PRECISE float angle = t + t * (t2 * p);
    if (abs(y) > abs(x)) angle = 1.57079637f - angle;
    if (x < 0.0f) angle = 3.14159274f - angle;
    return y < 0.0f ? -angle : angle;
}

// 1 / sqrt(x) for x from 2^-125 to 2^127: 2 ulp. For 0: a large number, so that 0 times it is 0. An
// estimate from the bits (off by 3.5 %), then Newton's method, thrice.
inline float inverse_sqrt(float x) {
    const float half_x = 0.5f * x;
    float y = float_from_bits(0x5f375a86u - (float_bits(x) >> 1));
    y = y * (1.5f - half_x * y * y);
    y = y * (1.5f - half_x * y * y);
    PRECISE float correction = 0.5f - half_x * y * y;
    correction = y + y * correction;
    return correction;
}

inline float vector_length(vec3 v) {
    return sqrt(dot(v, v));
}
// For lengths whose square is a float of full precision; 0 for 0.
inline vec3 unit_vector(vec3 v) {
    return v * inverse_sqrt(dot(v, v));
}

SHADING_END

#endif
