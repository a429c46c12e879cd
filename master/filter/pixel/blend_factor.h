#pragma once

#include <algorithm>
#include <cmath>

// Schwenk 3.3.5 and App. 3.A: the weight of the unfiltered light in the picture. Functions of one pixel
// without branches, so that loops over rows vectorise.
namespace tessera::filter::pixel {

// Upper bound of variances, so that products stay finite; there the weight is below 1e-8 anyway.
inline constexpr float MostVariance = 1e18f;

// Perceived variance of a mean, relative to the surrounding light (Schwenk 3.4). Finite for background 0.
inline float perceived_variance(float variance, float background) {
    const float ratio = std::sqrt(std::max(variance, 0.0f)) / std::max(background, 1e-18f);
    return std::min(ratio, 1e9f) * std::min(ratio, 1e9f);
}

// Weight s of the unfiltered value so that s^2 u + (1 - s)^2 f = t (Schwenk 3.12, 3.13), for perceived
// variances u (unfiltered), f (filtered) and the threshold t, all >= 0. In order: 1 where u <= t; 0 where
// even the filtered value is too noisy; else the larger root. Jumps from f / (u + f) to 0 at u = f t / (f -
// t). The discriminant counts as 0 within 1e-6 of its terms: it is 0 there except for rounding.
inline float blend_factor(float u, float f, float t) {
    u = std::min(u, MostVariance);
    f = std::min(f, MostVariance);
    const float terms = t * u + t * f;
    const float discriminant = terms - u * f;
    const float root = (f + std::sqrt(std::max(discriminant, 0.0f))) / std::max(u + f, 1e-30f);
    const float blend = discriminant < -1e-6f * terms ? 0.0f : std::min(root, 1.0f);
    return u <= t ? 1.0f : blend;
}

// The same with Cov = a u, a = the weight that the filter gives to the pixel itself (Schwenk 3.7, 3.8): the
// larger root of s^2 (u + f - 2 a u) - 2 s (f - a u) + f - t = 0 within [0, 1]. No jump: where the threshold
// cannot be met, the root has reached 0.
inline float blend_factor(float u, float f, float t, float a) {
    u = std::min(u, MostVariance);
    f = std::min(f, MostVariance);
    const float covariance = a * u;
    const float difference = std::max(u + f - 2.0f * covariance, 1e-6f * u + 1e-30f);
    const float half = f - covariance;
    const float discriminant = half * half - difference * (f - t);
    const float root = (half + std::sqrt(std::max(discriminant, 0.0f))) / difference;
    const float blend = discriminant < 0.0f ? 0.0f : std::clamp(root, 0.0f, 1.0f);
    return u <= t ? 1.0f : blend;
}

// Weight of the pixel itself in a filter whose squared weights sum to r. A Gaussian of sigma s in the plane
// has r = 1 / (4 pi s^2) and a centre of 1 / (2 pi s^2) = 2 r; a filter that finds no neighbours has r = a =
// 1. 2 r / (1 + r) matches both, and is between the bounds r and sqrt(r) of every filter whose largest weight
// is the centre's.
inline float central_weight(float reduction) {
    return 2.0f * reduction / (1.0f + reduction);
}

// L_u between L_f / c and c L_f (Schwenk 3.18), per channel. Only for pixels with s < 1: spikes of a
// converged pixel are real.
inline float clamp_spike(float unfiltered, float filtered, float c) {
    return std::min(std::max(unfiltered, filtered / c), filtered * c);
}

}  // namespace tessera::filter::pixel
