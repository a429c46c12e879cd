#ifndef TESSERA_MEDIATOR_SHADING_SAMPLER_H
#define TESSERA_MEDIATOR_SHADING_SAMPLER_H

#include "mediator/shading/language.h"

// Random numbers of a path. They come in sets of four: each set is a low-discrepancy sequence of four dimensions by
// absolute sample index, Owen-scrambled (Burley 2020: hash-based nested uniform scrambling; constants of the
// permutation: Vegdahl's improvement of Laine and Karras 2011). A set's index and its coordinates are scrambled by
// hashes of (pixel, set), so that sets and pixels are independent of each other.
//
// The sequence is the (0,4)-sequence in base 4 of Faure's construction over the field GF(4) (Niederreiter 1987, Ahmed et
// al. 2024): any aligned block of 4^m samples has one sample in each of the 4^m boxes of any split of the unit cube
// into powers of 4. The digits of the fraction are mapped to bits so that the first two coordinates, and the last two,
// are (0,2)-sequences in base 2 as well: each pair is stratified in any aligned block of 2^m samples.
RECORDS_BEGIN

// Identifies the sequence of one sample of one pixel.
struct Sampler {
    uint index;  // of the sample, low 32 bits
    uint seed;   // of (pixel, view's seed, high bits of the index)
};

// A sample's place in the sequence of one set: what all four of its numbers need.
struct SampleSet {
    uint index;  // scrambled
    uint seed;   // of (pixel, set)
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

// Arithmetic on 16 elements of GF(4) at once, two bits each: 0, 1, w and w^2 = w + 1.
inline uint times_w(uint x) {
    const uint high = (x >> 1) & 0x55555555u;
    return (((x & 0x55555555u) ^ high) << 1) | high;
}

inline uint times_w_squared(uint x) {
    return times_w(x) ^ x;
}

// Element i times w^i.
inline uint times_powers_of_w(uint x) {
    const uint once = times_w(x);
    return (x & 0xc30c30c3u) | (once & 0x0c30c30cu) | ((once ^ x) & 0x30c30c30u);
}

// Element i times w^-i.
inline uint divided_by_powers_of_w(uint x) {
    const uint once = times_w(x);
    return (x & 0xc30c30c3u) | ((once ^ x) & 0x0c30c30cu) | (once & 0x30c30c30u);
}

// Element i becomes the sum of the elements j >= i times the binomial coefficients (j over i), doubling the reach four
// times (Ahmed 2024).
inline uint times_pascal(uint x) {
    x ^= x >> 16;
    x ^= (x >> 8) & 0x00ff00ffu;
    x ^= (x >> 4) & 0x0f0f0f0fu;
    return x ^ ((x >> 2) & 0x33333333u);
}

// Four coordinates of the sequence at an index, bits reversed: generator matrices P(0) = identity, P(1), P(w) and
// P(w^2), with P(a) = (j over i) a^(j-i).
inline uvec4 sequence_reversed(uint index) {
    const uint second = times_w_squared(times_pascal(index));
    const uint third = divided_by_powers_of_w(times_pascal(times_powers_of_w(index)));
    const uint fourth = times_w_squared(times_powers_of_w(times_pascal(divided_by_powers_of_w(index))));
    return uvec4(index, second, third, fourth);
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

inline SampleSet sample_set(IN(Sampler) numbers, uint set) {
    const uint seed = hash_combine(numbers.seed, set);
    return SampleSet(reverse_bits(scramble_reversed(reverse_bits(numbers.index), seed)), seed);
}

inline float scrambled(IN(SampleSet) set, uint reversed, uint dimension) {
    return unit_float(reverse_bits(scramble_reversed(reversed, hash_combine(set.seed, dimension + 1u))));
}

// The first two numbers of a set, and the last two.
inline vec2 first_pair(IN(SampleSet) set) {
    const uvec4 reversed = sequence_reversed(set.index);
    return vec2(scrambled(set, reversed.x, 0u), scrambled(set, reversed.y, 1u));
}

inline vec2 second_pair(IN(SampleSet) set) {
    const uvec4 reversed = sequence_reversed(set.index);
    return vec2(scrambled(set, reversed.z, 2u), scrambled(set, reversed.w, 3u));
}

inline vec2 sample_pair(IN(Sampler) numbers, uint set) {
    return first_pair(sample_set(numbers, set));
}

SHADING_END

#endif
