#pragma once

#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

// Warps of the unit square and their densities. Written for C++ with GLM and for GLSL alike: plain values, no
// recursion.
namespace tessera::shading {

inline constexpr float Pi = 3.14159265358979f;

inline float luminance(const glm::vec3& color) {
    return dot(color, glm::vec3(0.2126f, 0.7152f, 0.0722f));
}
// As fmax and fmin: what is not a number loses. Written out, because compilers call the library for those.
inline float greater_of(float a, float b) {
    return a > b || b != b ? a : b;
}
inline float lesser_of(float a, float b) {
    return a < b || b != b ? a : b;
}
inline float largest(const glm::vec3& v) {
    return greater_of(v.x, greater_of(v.y, v.z));
}

// Orthonormal frame with n as third axis (Duff et al. 2017).
inline glm::mat3 frame_around(const glm::vec3& n) {
    const float sign = n.z >= 0.0f ? 1.0f : -1.0f;
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    return glm::mat3(glm::vec3(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x),
                     glm::vec3(b, sign + n.y * n.y * a, -n.y), n);
}

// Concentric map of the square to the disk (Shirley and Chiu 1997).
inline glm::vec2 sample_disk(const glm::vec2& u) {
    const glm::vec2 p = 2.0f * u - 1.0f;
    if (p.x == 0.0f && p.y == 0.0f) return glm::vec2(0.0f);
    float radius = p.x, angle = (Pi / 4.0f) * (p.y / p.x);
    if (std::fabs(p.x) <= std::fabs(p.y)) {
        radius = p.y;
        angle = Pi / 2.0f - (Pi / 4.0f) * (p.x / p.y);
    }
    return radius * glm::vec2(std::cos(angle), std::sin(angle));
}

// Density cos / pi, z up.
inline glm::vec3 sample_cosine_hemisphere(const glm::vec2& u) {
    const glm::vec2 d = sample_disk(u);
    return glm::vec3(d, std::sqrt(greater_of(0.0f, 1.0f - dot(d, d))));
}

// Density 1 / (4 pi).
inline glm::vec3 sample_sphere(const glm::vec2& u) {
    const float z = 1.0f - 2.0f * u.x;
    const float r = std::sqrt(greater_of(0.0f, 1.0f - z * z));
    return glm::vec3(r * std::cos(2.0f * Pi * u.y), r * std::sin(2.0f * Pi * u.y), z);
}

// Barycentric weights of the second and third vertex, uniform over the triangle.
inline glm::vec2 sample_triangle(const glm::vec2& u) {
    const float root = std::sqrt(u.x);
    return glm::vec2(root * (1.0f - u.y), root * u.y);
}

// Power heuristic of two strategies with one sample each (Veach 1997). Densities may be as large as floats
// go.
inline float power_heuristic(float pdf, float other) {
    if (!(pdf > 0.0f)) return 0.0f;
    const float ratio = other / pdf;
    return 1.0f / (1.0f + ratio * ratio);
}

// Filter importance sampling: where in the neighbourhood of the pixel's centre a sample lies. One axis; both
// filters are separable. Gaussian: sigma = radius / 3, cut at the radius. Blackman-Harris: by inversion of
// its integral.
inline float gaussian_offset(float u, float radius) {
    // Inverse of the error function (Giles 2010), scaled so that the cut tails carry no probability.
    const float x = (2.0f * u - 1.0f) * 0.9973002f;  // erf(3 / sqrt 2)
    float w = -std::log((1.0f - x) * (1.0f + x));
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
        w = std::sqrt(w) - 3.0f;
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
    return p * x * 1.41421356f * (radius / 3.0f);
}

// Integral of the window from -radius to t * radius, normalised to 1 (Harris 1978, four terms).
inline float blackman_harris_integral(float t) {
    const float x = 0.5f * (t + 1.0f);
    const float s = 2.0f * Pi * x;
    return x + (-0.48829f / 0.35875f * std::sin(s) + 0.5f * 0.14128f / 0.35875f * std::sin(2.0f * s) -
                0.01168f / (3.0f * 0.35875f) * std::sin(3.0f * s)) /
                   (2.0f * Pi);
}

inline float blackman_harris_offset(float u, float radius) {
    float low = -1.0f, high = 1.0f;
    for (int i = 0; i < 24; ++i) {  // bisection to the last bit that counts
        const float middle = 0.5f * (low + high);
        if (blackman_harris_integral(middle) < u) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return 0.5f * (low + high) * radius;
}

}  // namespace tessera::shading
