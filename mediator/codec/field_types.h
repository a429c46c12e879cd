#pragma once

#include <array>
#include <bit>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <optional>
#include <type_traits>
#include <vector>

#include "mediator/base/clock.h"
#include "mediator/base/description.h"
#include "mediator/base/ids.h"
#include "mediator/codec/format.h"

// The field types of the codec, and the encoding of numbers.
namespace tessera::codec {

// Specialised for types with a custom layout: write(FormatWriter&, const T&) and read(FormatReader&, T&) of the message's
// content.
template <class T>
struct CustomCodec;

namespace detail {

template <class T>
inline constexpr bool is_id = false;
template <class Tag>
inline constexpr bool is_id<Id<Tag>> = true;
template <class T>
inline constexpr bool is_list = false;
template <class T>
inline constexpr bool is_list<std::vector<T>> = true;
template <class T>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<std::optional<T>> = true;

template <class T>
concept Number = std::is_arithmetic_v<T> || std::is_enum_v<T> || is_id<T> || std::is_same_v<T, Duration>;
template <class T>
concept Set = requires(T set) {
    T::from_bits(set.bits());
};
template <class T>
concept Custom = requires(FormatWriter& out, FormatReader& in, T& value) {
    CustomCodec<T>::write(out, value);
    CustomCodec<T>::read(in, value);
};
template <class T>
concept Message = Described<T> || Oneof<T> || Custom<T>;

// Types that consist of a fixed number of floating-point values, like those of glm.
template <class T>
struct Packed {
    static constexpr std::size_t count = 0;
};
template <class T>
requires std::is_floating_point_v<T>
struct Packed<T> {
    static constexpr std::size_t count = 1;
    using Element = T;
};
template <glm::length_t L, class N>
struct Packed<glm::vec<L, N>> {
    static constexpr std::size_t count = L;
    using Element = N;
};
template <glm::length_t C, glm::length_t R, class N>
struct Packed<glm::mat<C, R, N>> {
    static constexpr std::size_t count = C * R;
    using Element = N;
};
template <class T>
concept Vector =
    !Number<T> && (Packed<T>::count > 0) && std::is_floating_point_v<typename Packed<T>::Element> &&
    (sizeof(T) == Packed<T>::count * sizeof(typename Packed<T>::Element));

template <Number T>
constexpr WireType number_type(bool full_width) {
    if (std::is_same_v<T, float>) return WireType::Fixed32;
    return std::is_same_v<T, double> || full_width ? WireType::Fixed64 : WireType::Varint;
}

// A number as encoded bits; 0 only for 0 (not for -0.0).
template <Number T>
std::uint64_t to_bits(const T& value, bool full_width) {
    if constexpr (is_id<T>) {
        return value.value;
    } else if constexpr (std::is_same_v<T, Duration>) {
        return zigzag(value.count());
    } else if constexpr (std::is_same_v<T, float>) {
        return std::bit_cast<std::uint32_t>(value);
    } else if constexpr (std::is_same_v<T, double>) {
        return std::bit_cast<std::uint64_t>(value);
    } else if constexpr (std::is_signed_v<T>) {
        return full_width ? static_cast<std::uint64_t>(value) : zigzag(value);
    } else {
        return static_cast<std::uint64_t>(value);
    }
}

template <Number T>
T from_bits(FormatReader& in, std::uint64_t bits) {
    if constexpr (is_id<T>) {
        return T{bits};
    } else if constexpr (std::is_same_v<T, Duration>) {
        return Duration(unzigzag(bits));
    } else if constexpr (std::is_same_v<T, float>) {
        return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    } else if constexpr (std::is_same_v<T, double>) {
        return std::bit_cast<double>(bits);
    } else if constexpr (std::is_same_v<T, bool>) {
        return bits != 0;
    } else if constexpr (std::is_enum_v<T>) {
        static_assert(Enumerated<T>, "needs an enumerators() function");
        if (bits >= enumerator_count<T>) in.fail("an enumerator is unknown");
        return static_cast<T>(bits);
    } else if constexpr (std::is_signed_v<T>) {
        const std::int64_t value = unzigzag(bits);
        if (value > std::numeric_limits<T>::max() || value < std::numeric_limits<T>::min())
            in.fail("a number is too large");
        return static_cast<T>(value);
    } else {
        if (bits > std::numeric_limits<T>::max()) in.fail("a number is too large");
        return static_cast<T>(bits);
    }
}

inline void put_bits(FormatWriter& out, WireType type, std::uint64_t bits) {
    if (type == WireType::Varint) return out.varint(bits);
    if (type == WireType::Fixed32) return out.fixed(static_cast<std::uint32_t>(bits));
    out.fixed(bits);
}
inline std::uint64_t get_bits(FormatReader& in, WireType type) {
    if (type == WireType::Varint) return in.varint();
    return type == WireType::Fixed32 ? in.fixed<std::uint32_t>() : in.fixed<std::uint64_t>();
}

}  // namespace detail

}  // namespace tessera::codec
