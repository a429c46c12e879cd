#ifndef TESSERA_MEDIATOR_SHADING_LANGUAGE_H
#define TESSERA_MEDIATOR_SHADING_LANGUAGE_H

// The language of the headers here that say SHADING_BEGIN: one text that is C++20 (with GLM) for the Embree
// back-end and GLSL 460 (glslc, target Vulkan 1.3) for the Vulkan back-end. A shader starts with
//     #version 460
//     #extension GL_GOOGLE_include_directive : require
//     #include "mediator/shading/..."
//
// What a shared file looks like:
// - Include guard TESSERA_MEDIATOR_SHADING_NAME_H, since GLSL includes it too; then the includes,
//   SHADING_BEGIN, the code, SHADING_END; RECORDS_BEGIN and RECORDS_END around types that all kernels share.
// - Constants are `inline constexpr float Name = 1.0f;`, functions `inline T name(...)`.
// - Types: float, int, uint, bool, uint64_t, vec2/3/4, ivec2/3/4, uvec2/3/4, mat3, structs of them, arrays of
//   fixed size. A `bool` never lies in a struct that goes through memory: `uint` does.
// - Parameters: by value, or IN(T), OUT(T), INOUT(T) for structs, matrices and what a function fills.
// - Aggregates are filled member by member, or at once and completely: Numbers(index, seed).
// - `float(x)`, `uint(x)` convert; float_bits, float_from_bits look at bits; is_nan, is_finite work even if a
//   compiler takes all numbers to be finite. PRECISE before a local variable forbids contraction in what is
//   assigned to it, where bits matter (C++ is compiled so everywhere).
// - KEEP_LOOP before a loop asks a shader's compiler not to unroll it.
// - KEPT(T) before a local name for one of two things that lie elsewhere: in C++ no copy of it.
// - SELDOM before a function that few scenes call keeps it out of the way of those around it, in C++.
// - GENERIC(T) before a function with a parameter of a type T that the includer brings: a template in C++; in
//   GLSL T is a struct that is known before.
// - Data in buffers: ARRAY_OF(Item, ItemArray, alignment) declares a type of the size of an address, whose
//   `.items[i]` reads on both sides. Its members and items are laid out as in C++ (scalar layout).
// - FeatureBits is a number whose bits are records.h's features, asked for by `&`.
// - WITH_CONTEXT stands before a function with a parameter IN(Context): a type of the including side, through
//   which rays are asked for (transport.h).
//
// What it must not have:
// - references, pointers, templates, member functions, default member initialisers, default arguments, enums,
//   braces that construct, static_cast, hexadecimal floats, swizzles, recursion, std:: and glm::; double and
//   half (devices need not have them).
// - sin, cos, tan, asin, acos, atan, exp, exp2, log, log2, pow, inversesqrt, normalize, length, distance of
//   the driver: they may be off by 2^-11. maths.h has our own.
// - min, max, clamp where an argument may be no number: GLSL leaves the result open. greater_of and lesser_of
//   do not.
// - GLSL's words as names: in, out, inout, sample, sampler, filter, input, output, active, common, partition,
//   half, fixed, buffer, shared, patch, flat, smooth, resource, precise, texture and image types.
// - Names of GLSL's own functions for something else.

#ifdef __cplusplus

#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

// A source that defines SHADING_KERNEL, a name, before it includes any shared file has all of their functions
// for itself, compiled for scenes with no other features than SHADING_FEATURES; with SHADING_HAS_ALL_FEATURES
// for those that have them all. Records are everyone's.
#define RECORDS_BEGIN namespace tessera::shading {
#define RECORDS_END }
#ifdef SHADING_KERNEL
#define SHADING_BEGIN            \
    namespace tessera::shading { \
    inline namespace SHADING_KERNEL {
#define SHADING_END \
    }               \
    }
#else
#define SHADING_FEATURES 0xffffffffu
#define SHADING_BEGIN RECORDS_BEGIN
#define SHADING_END RECORDS_END
#endif
#define IN(T) const T&
#define OUT(T) T&
#define INOUT(T) T&
#define PRECISE
#define KEEP_LOOP
#define KEPT(T) const T&
#define SELDOM [[gnu::cold, gnu::noinline]]
#define WITH_CONTEXT template <class Context>
#define GENERIC(T) template <class T>
#define ARRAY_OF(Item, Name, alignment) \
    struct Name {                       \
        const Item* items;              \
    }

namespace tessera::shading {

using uint = std::uint32_t;
using glm::floor, glm::min, glm::max, glm::clamp, glm::mix, glm::dot, glm::cross;
using glm::ivec2, glm::ivec3, glm::ivec4, glm::uvec2, glm::uvec3, glm::uvec4;
using glm::vec2, glm::vec3, glm::vec4, glm::mat3;
using std::sqrt;
using std::uint64_t;

// Not GLM's, which compare: to clear the sign is one instruction.
inline float abs(float x) {
    return std::fabs(x);
}
inline vec2 abs(const vec2& v) {
    return vec2(abs(v.x), abs(v.y));
}
inline vec3 abs(const vec3& v) {
    return vec3(abs(v.x), abs(v.y), abs(v.z));
}
inline uint float_bits(float x) {
    return std::bit_cast<uint>(x);
}
inline float float_from_bits(uint bits) {
    return std::bit_cast<float>(bits);
}
inline uint lowest_bit(uint bits) {  // its index; bits != 0
    return static_cast<uint>(std::countr_zero(bits));
}
inline bool is_nan(float x) {
    return x != x;
}
inline bool is_finite(float x) {
    return std::fabs(x) <= 3.40282347e38f;
}

struct FeatureBits {
    uint bits;

    FeatureBits() = default;
    constexpr FeatureBits(uint some) : bits(some) {}
    constexpr operator uint() const { return bits; }
    constexpr FeatureBits& operator|=(uint more) { return *this = bits | more; }
    constexpr FeatureBits& operator&=(uint some) { return *this = bits & some; }
};

}  // namespace tessera::shading

#else

#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require

#define SHADING_BEGIN
#define SHADING_END
#define RECORDS_BEGIN
#define RECORDS_END
#define FeatureBits uint
#define inline
#define constexpr const
#define IN(T) const in T
#define OUT(T) out T
#define INOUT(T) inout T
#define PRECISE precise
#define KEEP_LOOP [[dont_unroll]]
#define KEPT(T) T
#define SELDOM
#define WITH_CONTEXT
#define GENERIC(T)
#define ARRAY_OF(Item, Name, alignment)                                                         \
    layout(buffer_reference, scalar, buffer_reference_align = alignment) readonly buffer Name { \
        Item items[];                                                                           \
    }

#define float_bits floatBitsToUint
#define float_from_bits uintBitsToFloat

uint lowest_bit(uint bits) {
    return uint(findLSB(bits));
}

// By bits: a driver may leave out comparisons with what is no number.
bool is_nan(float x) {
    return (floatBitsToUint(x) & 0x7fffffffu) > 0x7f800000u;
}
bool is_finite(float x) {
    return (floatBitsToUint(x) & 0x7fffffffu) < 0x7f800000u;
}

#endif

SHADING_BEGIN

inline float infinity() {
    return float_from_bits(0x7f800000u);
}

SHADING_END

#endif
