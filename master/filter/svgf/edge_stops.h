#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "master/filter/kernels.h"

// Edge-stopping weights between neighbours (Dundr 2.4). All weights are symmetric, so that one serves both
// ends of a pair; where a published weight only depends on its centre, the stricter of both ends is used, but for luminance
// (Pair).
namespace tessera::filter::svgf {

// Divisor of a luminance difference (E-D11).
enum class Deviation : std::uint8_t {
    Mean,      // age: standard deviation of the mean, sqrt(var / age)
    Variance,  // dundr: var of one sample, as printed
    Sample,    // svgf: sqrt(var) of one sample
};

// Whose deviation a luminance difference is measured in. The smaller one (E-D11) keeps a bright find as a speck: pixels that
// found nothing have no variance. The larger one is within sqrt(2) of the deviation of the difference, and mixes it with them.
// relMSE over that of the samples, geometric mean of eight scenes at 4, 16 and 64 samples, with Dundr's settings and with the
// present ones (larger, no blur of the variance, both_ends, sigma_l 1.75 with 4 samples and 1.1 with 64):
//
//     0.51 0.54 0.44    0.30 0.39 0.40    all pixels
//     0.51 0.52 0.49    0.41 0.43 0.49    without the worst 0.1 % of them
//
// A history knows more of the variance, and the reprojection has spread its finds: it needs less. On paths of the camera with
// 4 samples a picture, six scenes have 0.031 to 0.40 times the error of the samples with a sigma_l that goes to 0.95, the more of
// the picture is history the smaller (geometric mean 0.073), and 0.036 to 0.67 with Dundr's settings (0.082).
//
// While the variances of pixels are those of their neighbourhood the smaller one, blurred and with sigma_l 4, leaves fewer
// specks (11 instead of 14 % at one sample) and edges that are as sharp.
enum class Pair : std::uint8_t { Larger, Smaller };

struct EdgeStops {
    float sigma_n = 64.0f;  // exponent of the normals' cosine
    float sigma_d = 1.0f;   // slopes of inverse depth that a tap may be off
    float eps_d = 0.005f;   // of the inverse depth itself
    float steep = 0.2f;     // relative change of depth per pixel above which depth is ignored
    float sigma_l = 1.75f;
    float eps_l = 0.01f;  // of the luminance itself
    Deviation deviation = Deviation::Mean;
    Pair pair = Pair::Larger;
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

// Of a pair, from those of its ends.
template <Pair Deviation>
inline float luminance_scale_of(float a, float b) {
    return Deviation == Pair::Larger ? std::min(a, b) : std::max(a, b);
}

}  // namespace tessera::filter::svgf
