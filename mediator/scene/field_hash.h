#pragma once

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

// What the fields of scene objects are made of, fed to a hash bit by bit: equal bits, equal hash, on every
// machine (little-endian; strings and lists with their length in front).
namespace tessera::scene {

template <class T>
requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) void feed(Blake2b& hash, const T& value) {
    hash.update(std::as_bytes(std::span(&value, 1)));
}

template <glm::length_t L, class T>
void feed(Blake2b& hash, const glm::vec<L, T>& value) {
    for (glm::length_t i = 0; i < L; ++i) feed(hash, value[i]);
}

inline void feed(Blake2b& hash, const glm::dmat4& value) {
    for (glm::length_t i = 0; i < 4; ++i) feed(hash, value[i]);
}

inline void feed(Blake2b& hash, const std::string& value) {
    feed(hash, std::uint64_t{value.size()});
    hash.update(std::as_bytes(std::span(value)));
}

inline void feed(Blake2b& hash, ObjectId value) {
    feed(hash, value.value);
}

inline void feed(Blake2b& hash, const std::vector<ObjectId>& values) {
    feed(hash, std::uint64_t{values.size()});
    for (const ObjectId value : values) feed(hash, value);
}

inline void feed(Blake2b& hash, const BlobRef& value) {
    hash.update(value.hash.bytes);
    feed(hash, value.byte_size);
}

template <class T>
requires(std::is_same_v<T, glm::dmat4> ||
         std::is_same_v<T, BlobRef>) void feed(Blake2b& hash, const std::vector<T>& values) {
    feed(hash, std::uint64_t{values.size()});
    for (const T& value : values) feed(hash, value);
}

inline void feed(Blake2b& hash, const TextureSlot& value) {
    feed(hash, value.texture);
    feed(hash, value.offset);
    feed(hash, value.scale);
    feed(hash, value.rotation);
    feed(hash, value.set);
}

}  // namespace tessera::scene
