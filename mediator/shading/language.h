#ifndef TESSERA_MEDIATOR_SHADING_LANGUAGE_H
#define TESSERA_MEDIATOR_SHADING_LANGUAGE_H

// Headers in this folder that use SHADING_BEGIN compile both as C++20 (with GLM) for the Embree back-end and
// as GLSL 460 (glslc, target Vulkan 1.3) for the Vulkan back-end. A shader starts with
//     #version 460
//     #extension GL_GOOGLE_include_directive : require
//     #include "mediator/shading/..."
//
// Conventions of shared headers:
// - Include guard TESSERA_MEDIATOR_SHADING_NAME_H, since GLSL includes it too; then the includes,
//   SHADING_BEGIN, the code, SHADING_END. RECORDS_BEGIN and RECORDS_END enclose types that all kernels share.
// - Constants are `inline constexpr float Name = 1.0f;`, functions `inline T name(...)`.
// - Types: float, int, uint, bool, uint64_t, vec2/3/4, ivec2/3/4, uvec2/3/4, mat3, structs of them, arrays of
//   fixed size. Structs that are stored in buffers use `uint` instead of `bool`.
// - Parameters: by value, or IN(T), OUT(T), INOUT(T) for structs, matrices and output parameters.
// - Aggregates are initialised member by member, or completely: Sampler(index, seed).
// - `float(x)`, `uint(x)` convert; float_bits, float_from_bits reinterpret bits; is_nan, is_finite work even
//   if a compiler assumes that all numbers are finite. PRECISE before a local variable forbids contraction in
//   the expression assigned to it (all C++ is compiled without contraction).
// - NO_UNROLL before a loop asks the shader compiler not to unroll it.
// - CONST_REF(T) declares a local that refers to one of two existing objects: a const reference in C++, a
//   copy in GLSL.
// - COLD_NOINLINE marks a rarely called function as cold and never inlined, in C++.
// - GENERIC(T) before a function with a parameter of a type T that the including file defines: a template in
//   C++; in GLSL T is a struct declared before the include.
// - Data in buffers: ARRAY_OF(Item, ItemArray, alignment) declares an array reference of the size of an
//   address; `.items[i]` reads an element in both languages. Items are laid out as in C++ (scalar layout).
// - FeatureBits holds feature flags (records.h), tested by `&`.
// - WITH_CONTEXT precedes a function with a parameter IN(Context): a type that the including file defines,
//   through which rays are traced (transport.h).
//
// Not allowed:
// - references, pointers, templates, member functions, default member initialisers, default arguments, enums,
//   braces that construct, static_cast, hexadecimal floats, swizzles, recursion, std:: and glm::; double and
//   half (optional device features).
// - sin, cos, tan, asin, acos, atan, exp, exp2, log, log2, pow, inversesqrt, normalize, length, distance of
//   the driver: they may be off by 2^-11. Use those of maths.h.
// - min, max, clamp where an argument may be NaN: the result is undefined in GLSL. Use greater_of and
//   lesser_of.
// - GLSL's words as names: in, out, inout, sample, sampler, filter, input, output, active, common, partition,
//   half, fixed, buffer, shared, patch, flat, smooth, resource, precise, texture and image types.
// - Names of GLSL built-in functions with another meaning.

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

// A source that defines SHADING_KERNEL (a name) before it includes any shared header gets its own copy of all
// functions, compiled for scenes with no other features than SHADING_FEATURES; with SHADING_HAS_ALL_FEATURES,
// for scenes with any features. Records are shared by all kernels.
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
#define NO_UNROLL
#define CONST_REF(T) const T&
#define COLD_NOINLINE [[gnu::cold, gnu::noinline]]
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

// Instead of GLM's, which compare: clearing the sign bit is one instruction.
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
#define NO_UNROLL [[dont_unroll]]
#define CONST_REF(T) T
#define COLD_NOINLINE
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

// By bits: drivers may optimise comparisons with NaN away.
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
