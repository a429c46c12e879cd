#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>

// Eight pixels of a row at once. The pixel filter keeps the sums of eight pixels in registers while it walks
// over their neighbours; a loop over a row with sums in memory takes twice as long (measured).
namespace tessera::filter::pixel {

inline constexpr std::int64_t LaneCount = 8;
using Lanes = float __attribute__((vector_size(4 * LaneCount)));
using LaneBits = std::int32_t __attribute__((vector_size(4 * LaneCount)));

inline Lanes load(const float* from) {
    Lanes lanes;
    std::memcpy(&lanes, from, sizeof lanes);
    return lanes;
}

inline void store(float* to, Lanes lanes) {
    std::memcpy(to, &lanes, sizeof lanes);
}

inline Lanes splat(float value) {
    return Lanes{} + value;
}

inline Lanes larger(Lanes a, Lanes b) {
    return a > b ? a : b;
}

inline Lanes smaller(Lanes a, Lanes b) {
    return a < b ? a : b;
}

inline float largest(Lanes lanes) {
    float most = lanes[0];
    for (int i = 1; i < LaneCount; ++i) most = std::max(most, lanes[i]);
    return most;
}

// 2^-x for x >= 0, below 1e-37 from x = 125 on: a polynomial on [-1/2, 1/2] through the Chebyshev nodes of
// degree 4, relative error 3.5e-6, times a power of two that is added to the exponent. Adding 1.5 x 2^23
// rounds to an integer that then stands in the low bits.
inline Lanes exp2_negative(Lanes x) {
    constexpr float Magic = 12582912.0f;
    const Lanes most = smaller(x, splat(125.0f));
    const Lanes shifted = Magic - most;
    const Lanes f = (Magic - shifted) - most;
    Lanes p = splat(0.009666368515f);
    p = p * f + 0.05592197584f;
    p = p * f + 0.2402234904f;
    p = p * f + 0.6931210452f;
    p = p * f + 1.0f;
    LaneBits bits, exponent;
    std::memcpy(&bits, &p, sizeof bits);
    std::memcpy(&exponent, &shifted, sizeof exponent);
    bits += exponent << 23;
    Lanes result;
    std::memcpy(&result, &bits, sizeof result);
    return result;
}

}  // namespace tessera::filter::pixel
