#ifndef TESSERA_MEDIATOR_SHADING_SOBOL_H
#define TESSERA_MEDIATOR_SHADING_SOBOL_H

#include "mediator/shading/language.h"

// Sample sequence of a path. Owen-scrambled Sobol points by absolute sample index (Burley 2020: hash-based
// nested uniform scrambling; constants of the permutation: Vegdahl's improvement of Laine and Karras 2011).
// Dimensions come in pairs: each pair is a separate (0,2)-sequence, its index and its two coordinates
// scrambled by hashes of (pixel, pair), so that pairs and pixels are independent of each other and every
// aligned power-of-two block of samples is stratified.
RECORDS_BEGIN

// Identifies the sequence of one sample of one pixel.
struct Sampler {
    uint index;  // of the sample, low 32 bits
    uint seed;   // of (pixel, view's seed, high bits of the index)
};

RECORDS_END

SHADING_BEGIN

inline uint hash_u32(uint x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ (x >> 16);
}

inline uint hash_combine(uint seed, uint value) {
    return hash_u32(seed ^ (value + 0x9e3779b9u + (seed << 6) + (seed >> 2)));
}

inline uint reverse_bits(uint x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
    return (x >> 16) | (x << 16);
}

// Owen scrambling of a number whose bits are reversed: a bit is flipped by a hash of the lower ones.
inline uint scramble_reversed(uint x, uint seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    return x ^ x * 0x53a22864u;
}

// The second Sobol dimension (x + 1) of an index, its bits reversed: Pascal's triangle modulo 2, doubled five times
// (Ahmed 2024). The first dimension, reversed, is the index itself.
inline uint sobol_second_reversed(uint index) {
    index ^= index >> 16;
    index ^= (index >> 8) & 0x00ff00ffu;
    index ^= (index >> 4) & 0x0f0f0f0fu;
    index ^= (index >> 2) & 0x33333333u;
    return index ^ ((index >> 1) & 0x55555555u);
}

inline float unit_float(uint bits) {
    return float(bits >> 8) * 5.9604644775390625e-8f;
}  // [0, 1 - 2^-24]

inline Sampler make_sampler(uint x, uint y, uint64_t seed, uint64_t index) {
    uint s = hash_combine(hash_u32(x), y);
    s = hash_combine(s, uint(seed));
    s = hash_combine(s, uint(seed >> 32));
    return Sampler(uint(index), hash_combine(s, uint(index >> 32)));
}

inline vec2 sample_pair(IN(Sampler) numbers, uint pair) {
    const uint seed = hash_combine(numbers.seed, pair);
    const uint index = reverse_bits(scramble_reversed(reverse_bits(numbers.index), seed));
    const uint x = reverse_bits(scramble_reversed(index, hash_combine(seed, 1u)));
    const uint y = reverse_bits(scramble_reversed(sobol_second_reversed(index), hash_combine(seed, 2u)));
    return vec2(unit_float(x), unit_float(y));
}

SHADING_END

#endif
