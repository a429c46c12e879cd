#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "master/filter/kernels.h"

// Edge-stopping weights between neighbours (Dundr 2.4). All weights are symmetric, so that one serves both
// ends of a pair; where a published weight only depends on its centre, the stricter of both ends is used.
namespace tessera::filter::svgf {

// Divisor of a luminance difference (E-D11).
enum class Deviation : std::uint8_t {
    Mean,      // age: standard deviation of the mean, sqrt(var / age)
    Variance,  // dundr: var of one sample, as printed
    Sample,    // svgf: sqrt(var) of one sample
};

struct EdgeStops {
    float sigma_n = 64.0f;  // exponent of the normals' cosine
    float sigma_d = 1.0f;   // slopes of inverse depth that a tap may be off
    float eps_d = 0.005f;   // of the inverse depth itself
    float steep = 0.2f;     // relative change of depth per pixel above which depth is ignored
    float sigma_l = 4.0f;
    float eps_l = 0.01f;  // of the luminance itself
    Deviation deviation = Deviation::Mean;
};

// Replaces 0 in divisors: below it differences count as infinite.
inline constexpr float Tiny = 1e-20f;

// E-D4
inline float luma(float r, float g, float b) {
    return 0.299f * r + 0.587f * g + 0.114f * b;
}

// -ln(E-D9): -sigma ln(dot) by three terms of the series in 1 - dot, within 1e-4 sigma up to 25 degrees.
inline float normal_distance(float dot, float sigma) {
    const float u = 1.0f - dot;
    return sigma * u * (1.0f + u * (0.5f + u * (1.0f / 3.0f)));
}

// 1 / divisor of E-D10 towards a tap whose offset changes inverse depth by `change` on this surface.
inline float depth_scale(float inverse_depth, float change, const EdgeStops& stops) {
    return 1.0f / (stops.sigma_d * std::fabs(change) + stops.eps_d * inverse_depth + Tiny);
}

// 1 / divisor of E-D11. `spread` is the variance of the level, or its square root.
inline float luminance_scale(float luminance, float spread, const EdgeStops& stops) {
    return 1.0f / (stops.sigma_l * spread + stops.eps_l * std::fabs(luminance) + Tiny);
}

}  // namespace tessera::filter::svgf
