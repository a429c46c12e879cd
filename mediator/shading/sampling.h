#ifndef TESSERA_MEDIATOR_SHADING_SAMPLING_H
#define TESSERA_MEDIATOR_SHADING_SAMPLING_H

#include "mediator/shading/maths.h"

// Warps of the unit square and their densities.
SHADING_BEGIN

inline float luminance(vec3 color) {
    return dot(color, vec3(0.2126f, 0.7152f, 0.0722f));
}

// Orthonormal frame with n as third axis (Duff et al. 2017).
inline mat3 frame_around(vec3 n) {
    const float side = n.z >= 0.0f ? 1.0f : -1.0f;
    const float a = -1.0f / (side + n.z);
    const float b = n.x * n.y * a;
    return mat3(vec3(1.0f + side * n.x * n.x * a, side * b, -side * n.x), vec3(b, side + n.y * n.y * a, -n.y),
                n);
}

// Concentric map of the square to the disk (Shirley and Chiu 1997).
inline vec2 sample_disk(vec2 u) {
    const vec2 p = 2.0f * u - 1.0f;
    if (p.x == 0.0f && p.y == 0.0f) return vec2(0.0f);
    float radius = p.x, angle;
    if (abs(p.x) <= abs(p.y)) {
        radius = p.y;
        angle = Pi / 2.0f - (Pi / 4.0f) * (p.x / p.y);
    } else {
        angle = (Pi / 4.0f) * (p.y / p.x);
    }
    return radius * vec2(cosine(angle), sine(angle));
}

// sqrt(1 - d^2) for a point d of the disk, from the exact radius: 1 - d^2 would cancel at the rim.
inline float height_over_disk(vec2 u) {
    const vec2 p = abs(2.0f * u - 1.0f);
    const float radius = p.x > p.y ? p.x : p.y;
    return sqrt((1.0f - radius) * (1.0f + radius));
}

// Density cos / pi, z up.
inline vec3 sample_cosine_hemisphere(vec2 u) {
    return vec3(sample_disk(u), height_over_disk(u));
}

// Density 1 / (4 pi).
inline vec3 sample_sphere(vec2 u) {
    const float z = 1.0f - 2.0f * u.x;
    const float r = 2.0f * sqrt(u.x * (1.0f - u.x));
    return vec3(r * cosine(2.0f * Pi * u.y), r * sine(2.0f * Pi * u.y), z);
}

// Barycentric weights of the second and third vertex, uniform over the triangle.
inline vec2 sample_triangle(vec2 u) {
    const float root = sqrt(u.x);
    return vec2(root * (1.0f - u.y), root * u.y);
}

// Power heuristic of two strategies with one sample each (Veach 1997). Densities may be as large as floats
// go.
inline float power_heuristic(float pdf, float other) {
    if (!(pdf > 0.0f)) return 0.0f;
    const float ratio = other / pdf;
    return 1.0f / (1.0f + ratio * ratio);
}

// Filter importance sampling: the offset of a sample from the pixel's centre. One axis; both
// filters are separable. Gaussian: sigma = radius / 3, cut at the radius. Blackman-Harris: by inversion of
// its integral.
inline float gaussian_offset(float u, float radius) {
    // Inverse of the error function (Giles 2010), scaled so that the cut tails carry no probability.
    const float x = (2.0f * u - 1.0f) * 0.9973002f;  // erf(3 / sqrt 2)
    float w = -logarithm((1.0f - x) * (1.0f + x));
    float p;
    if (w < 5.0f) {
        w -= 2.5f;
        p = 2.81022636e-08f;
        p = 3.43273939e-07f + p * w;
        p = -3.5233877e-06f + p * w;
        p = -4.39150654e-06f + p * w;
        p = 0.00021858087f + p * w;
        p = -0.00125372503f + p * w;
        p = -0.00417768164f + p * w;
        p = 0.246640727f + p * w;
        p = 1.50140941f + p * w;
    } else {
        w = sqrt(w) - 3.0f;
        p = -0.000200214257f;
        p = 0.000100950558f + p * w;
        p = 0.00134934322f + p * w;
        p = -0.00367342844f + p * w;
        p = 0.00573950773f + p * w;
        p = -0.0076224613f + p * w;
        p = 0.00943887047f + p * w;
        p = 1.00167406f + p * w;
        p = 2.83297682f + p * w;
    }
    return p * x * 0.471404521f * radius;  // sqrt(2) / 3
}

// Integral of the window from -radius to t * radius, normalised to 1 (Harris 1978, four terms: 0.35875,
// 0.48829, 0.14128, 0.01168; the factors are those of the sines over 0.35875, 2 pi and their order).
inline float blackman_harris_integral(float t) {
    const float x = 0.5f * (t + 1.0f);
    const float s = 2.0f * Pi * x;
    return x + (-0.216623741f * sine(s) + 0.0313385510f * sine(2.0f * s) - 0.00172722856f * sine(3.0f * s));
}

inline float blackman_harris_offset(float u, float radius) {
    float low = -1.0f, high = 1.0f;
    for (int i = 0; i < 24; ++i) {  // bisection to the last significant bit
        const float mid = 0.5f * (low + high);
        if (blackman_harris_integral(mid) < u) {
            low = mid;
        } else {
            high = mid;
        }
    }
    return 0.5f * (low + high) * radius;
}

SHADING_END

#endif
