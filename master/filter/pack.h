#pragma once

#include <immintrin.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

// SIMD of eight floats, for inner loops that must keep their sums in registers, which the compiler does not
// do for loops over rows. Each operation compiles to one AVX2 instruction.
namespace tessera::filter {

using Pack [[gnu::vector_size(32)]] = float;
using IntPack [[gnu::vector_size(32)]] = std::int32_t;
inline constexpr std::uint32_t PackSize = 8;

inline Pack load(const float* from) {
    Pack v;
    std::memcpy(&v, from, sizeof v);
    return v;
}
inline void store(float* to, Pack v) {
    std::memcpy(to, &v, sizeof v);
}
inline Pack all(float x) {
    return Pack{x, x, x, x, x, x, x, x};
}
inline Pack bits(IntPack v) {
    return std::bit_cast<Pack>(v);
}
inline IntPack bits(Pack v) {
    return std::bit_cast<IntPack>(v);
}
// If one of the two is NaN, the result is the second.
inline Pack max(Pack a, Pack b) {
    return _mm256_max_ps(a, b);
}
inline Pack min(Pack a, Pack b) {
    return _mm256_min_ps(a, b);
}
inline float largest(Pack v) {
    float most = v[0];
    for (std::uint32_t i = 1; i < PackSize; ++i) most = std::max(most, v[i]);
    return most;
}
inline Pack abs(Pack v) {
    return bits(bits(v) & 0x7fffffff);
}
// v where a equals b, else 0.
inline Pack where_equal(Pack a, Pack b, Pack v) {
    return bits(bits(v) & (a == b));
}

// 2^-d for d >= 0, exactly 1 at 0; relative error below 3e-6; exactly 0 from 127 on. A polynomial of degree 4
// on
// [-1/2, 1/2] (minimax by reweighted least squares) times a power of two.
inline Pack exp2_negative(Pack d) {
    const Pack magic = all(12582912.0f);  // 1.5 * 2^23: the sum's low bits are the nearest integer
    const Pack near = min(all(127.0f), d);
    const Pack z = magic - near;
    const Pack r = (magic - z) - near;
    Pack p = all(0.00958285299f);
    p = p * r + 0.0559064247f;
    p = p * r + 0.240240986f;
    p = p * r + 0.693124193f;
    p = p * r + 1.0f;
    return bits(bits(p) + (bits(z) << 23));
}

}  // namespace tessera::filter
