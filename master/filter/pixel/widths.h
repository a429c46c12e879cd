#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

// How wide the kernels of the pixel filter are, in pixels.
namespace tessera::filter::pixel {

// Standard deviation of iteration k = 1..iterations, such that the squares of all sum to sigma^2
// (Schwenk 3.14).
inline double iteration_sigma(double sigma, int k, int iterations) {
    return sigma * std::sqrt(3.0) * std::exp2(iterations - k) / std::sqrt(std::exp2(2 * iterations) - 1.0);
}

// Width that brings the perceived variance u of a mean of n samples down to the target t, near the guideline
// base / sqrt(n) (Schwenk 3.15 to 3.17): a box of extent e has (2 e + 1)^2 pixels, sigma = 1.5 e, and the
// result lies between guide / c and guide c.
inline float adaptive_sigma(float u, float t, float n, float base, float c) {
    const float guide = base / std::sqrt(std::max(n, 1.0f));
    const float extent = 0.5f * std::sqrt(u / t) - 0.5f;
    return std::min(std::max(1.5f * extent, guide / c), guide * c);
}

// r of the whole iterated separable filter over r of its first iteration alone, in flat regions, for
// iterations of sampled Gaussians cut at 3 sigma. 3/4 4^N / (4^N - 1) = 0.762 for wide kernels (the
// variances of Gaussians add), 1 when the kernels end within their pixel.
double reduction_ratio(double sigma, int iterations);

}  // namespace tessera::filter::pixel
