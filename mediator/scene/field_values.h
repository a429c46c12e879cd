#pragma once

#include <algorithm>
#include <cstring>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "mediator/base/hash.h"
#include "mediator/scene/objects.h"

// Bitwise comparison and hashing of the fields of scene objects: equal bits, equal hash, on every machine
// (little-endian; texts and lists are prefixed with their length). Both treat NaN as equal to itself and -0 as
// different from 0. Rows added after the first release are hashed only when they differ from their initial value, so
// that older files keep their state hash.
namespace tessera::scene {

// Types that are compared and hashed as raw bytes.
template <class T>
inline constexpr bool is_raw = std::is_arithmetic_v<T> || std::is_enum_v<T>;
template <glm::length_t L, class T>
inline constexpr bool is_raw<glm::vec<L, T>> = sizeof(glm::vec<L, T>) == L * sizeof(T);
template <>
inline constexpr bool is_raw<glm::dmat4> = sizeof(glm::dmat4) == 16 * sizeof(double);
template <class Tag>
inline constexpr bool is_raw<Id<Tag>> = true;
template <>
inline constexpr bool is_raw<Hash256> = true;

template <class T>
bool same_bits(const T& a, const T& b) {
    if constexpr (is_raw<T>) {
        // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): bits are compared on purpose
        return std::memcmp(&a, &b, sizeof a) == 0;
    } else if constexpr (Described<T>) {
        bool same = true;
        for_each_row<T>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
            same = same && same_bits(row_of<T, I>.of(a), row_of<T, I>.of(b));
        });
        return same;
    } else if constexpr (std::is_same_v<T, std::string>) {
        return a == b;
    } else {
        return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                          [](const auto& x, const auto& y) { return same_bits(x, y); });
    }
}

template <class T>
void feed(Blake2b& hash, const T& value) {
    if constexpr (is_raw<T>) {
        hash.update(std::as_bytes(std::span(&value, 1)));
    } else if constexpr (Described<T>) {
        for_each_row<T>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
            using Row = std::remove_cvref_t<decltype(row_of<T, I>)>;
            if constexpr (Row::template has<InitialWhenAbsent>) {
                if (same_bits(row_of<T, I>.of(value), row_of<T, I>.of(initial<T>()))) return;
                feed(hash, std::uint32_t{row_of<T, I>.number});
            }
            if constexpr (Row::template has<ZeroWhenAbsent>) {
                if (same_bits(row_of<T, I>.of(value),
                              std::remove_cvref_t<decltype(row_of<T, I>.of(value))>{}))
                    return;
                feed(hash, std::uint32_t{row_of<T, I>.number});
            }
            feed(hash, row_of<T, I>.of(value));
        });
    } else {
        feed(hash, std::uint64_t{value.size()});
        if constexpr (std::is_same_v<T, std::string>) {
            hash.update(std::as_bytes(std::span(value)));
        } else {
            for (const auto& entry : value) feed(hash, entry);
        }
    }
}

}  // namespace tessera::scene
