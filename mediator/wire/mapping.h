#pragma once

#include <google/protobuf/repeated_field.h>

#include <chrono>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "mediator/base/clock.h"
#include "mediator/base/error.h"
#include "mediator/base/ids.h"
#include "mediator/scene/objects.h"
#include "mediator/view/view.h"

// Private to wire/*.cpp. Every message is described once, by a template map(io, structure, message) that runs
// both ways: with a Writer the structure is read and the message filled, with a Reader the other way round,
// checked. A Reader throws Error{InvalidInput}, which decode() turns into a value.
namespace tessera::wire {

[[noreturn]] inline void malformed(const std::string& what) {
    throw Error(ErrorCode::InvalidInput, "malformed message: " + what);
}

// The largest value of each enumeration that travels; whatever is above is refused.
template <class E>
constexpr E last_of();

namespace detail {

template <class T>
struct IsId : std::false_type {};
template <class Tag>
struct IsId<Id<Tag>> : std::true_type {};

template <class Number, class T>
Number to_number(const T& value) {
    if constexpr (IsId<T>::value) {
        return value.value;
    } else if constexpr (std::is_same_v<T, Duration>) {
        return value.count();
    } else {
        return static_cast<Number>(value);
    }
}

template <class T, class Number>
T from_number(Number number) {
    if constexpr (IsId<T>::value) {
        return T{number};
    } else if constexpr (std::is_same_v<T, Duration>) {
        return Duration(number);
    } else if constexpr (std::is_enum_v<T>) {
        if (number > static_cast<Number>(last_of<T>())) malformed("an enumerator is unknown");
        return static_cast<T>(number);
    } else if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
        if (number > std::numeric_limits<T>::max()) malformed("a number is too large");
        return static_cast<T>(number);
    } else {
        return static_cast<T>(number);
    }
}

}  // namespace detail

class Writer {
  public:
    template <class T>
    using Ref = const T&;
    explicit Writer(scene::FieldMask mask = ~scene::FieldMask{0}) : mask_(mask) {}

    template <class Field>
    bool has(Field field) const {
        return (mask_ >> static_cast<unsigned>(field)) & 1u;
    }
    template <class T, class P, class N>
    void operator()(const T& value, P& message, N (P::*)() const, void (P::*set)(N)) const {
        (message.*set)(detail::to_number<N>(value));
    }
    void text(const std::string& value, std::string* to) const { *to = value; }
    template <class S, class P>
    void message(const S& value, P* to) const {
        map(Writer(), value, *to);
    }
    template <class Tag>
    void list(const std::vector<Id<Tag>>& values, google::protobuf::RepeatedField<std::uint64_t>* to,
              std::size_t) const {
        for (const auto& value : values) to->Add(value.value);
    }
    void texts(const std::vector<std::string>& values, google::protobuf::RepeatedPtrField<std::string>* to,
               std::size_t) const {
        for (const auto& value : values) *to->Add() = value;
    }
    template <class S, class P>
    void messages(const std::vector<S>& values, google::protobuf::RepeatedPtrField<P>* to,
                  std::size_t) const {
        for (const auto& value : values) map(Writer(), value, *to->Add());
    }
    template <glm::length_t L, class N>
    void vector(const glm::vec<L, N>& value, google::protobuf::RepeatedField<N>* to) const {
        for (glm::length_t i = 0; i < L; ++i) to->Add(value[i]);
    }
    void matrix(const glm::dmat4& value, google::protobuf::RepeatedField<double>* to) const {
        for (glm::length_t i = 0; i < 4; ++i) vector(value[i], to);
    }
    void matrices(const std::vector<glm::dmat4>& values, google::protobuf::RepeatedField<double>* to,
                  std::size_t) const {
        for (const glm::dmat4& value : values) matrix(value, to);
    }
    template <class A>
    void raw(const A& value, std::string* to) const {
        to->assign(reinterpret_cast<const char*>(value.data()), value.size());
    }

  private:
    scene::FieldMask mask_;
};

class Reader {
  public:
    template <class T>
    using Ref = T&;
    explicit Reader(scene::FieldMask mask = ~scene::FieldMask{0}) : mask_(mask) {}

    template <class Field>
    bool has(Field field) const {
        return (mask_ >> static_cast<unsigned>(field)) & 1u;
    }
    template <class T, class P, class N>
    void operator()(T& value, P& message, N (P::*get)() const, void (P::*)(N)) const {
        value = detail::from_number<T>((message.*get)());
    }
    void text(std::string& value, std::string* from) const { value = std::move(*from); }
    template <class S, class P>
    void message(S& value, P* from) const {
        map(Reader(), value, *from);
    }
    template <class Tag>
    void list(std::vector<Id<Tag>>& values, google::protobuf::RepeatedField<std::uint64_t>* from,
              std::size_t limit) const {
        if (static_cast<std::size_t>(from->size()) > limit) malformed("a list is too long");
        values.clear();
        for (const std::uint64_t value : *from) values.push_back({value});
    }
    void texts(std::vector<std::string>& values, google::protobuf::RepeatedPtrField<std::string>* from,
               std::size_t limit) const {
        if (static_cast<std::size_t>(from->size()) > limit) malformed("a list is too long");
        values.assign(from->begin(), from->end());
    }
    template <class S, class P>
    void messages(std::vector<S>& values, google::protobuf::RepeatedPtrField<P>* from,
                  std::size_t limit) const {
        if (static_cast<std::size_t>(from->size()) > limit) malformed("a list is too long");
        values.clear();
        for (P& value : *from) {
            S item{};
            map(Reader(), item, value);
            values.push_back(std::move(item));
        }
    }
    template <glm::length_t L, class N>
    void vector(glm::vec<L, N>& value, google::protobuf::RepeatedField<N>* from) const {
        if (from->size() != L) malformed("a vector has another length than it should");
        for (glm::length_t i = 0; i < L; ++i) value[i] = from->Get(i);
    }
    void matrix(glm::dmat4& value, google::protobuf::RepeatedField<double>* from) const {
        if (from->size() != 16) malformed("a matrix does not have 16 numbers");
        for (int i = 0; i < 16; ++i) value[i / 4][i % 4] = from->Get(i);
    }
    void matrices(std::vector<glm::dmat4>& values, google::protobuf::RepeatedField<double>* from,
                  std::size_t limit) const {
        if (from->size() % 16 != 0) malformed("matrices do not have 16 numbers each");
        if (static_cast<std::size_t>(from->size()) > limit * 16) malformed("a list is too long");
        values.resize(static_cast<std::size_t>(from->size()) / 16);
        for (int i = 0; i < from->size(); ++i) {
            values[static_cast<std::size_t>(i / 16)][i / 4 % 4][i % 4] = from->Get(i);
        }
    }
    template <class A>
    void raw(A& value, std::string* from) const {
        if (from->size() != value.size()) malformed("a hash has another length than it should");
        const auto* data = reinterpret_cast<const typename A::value_type*>(from->data());
        std::copy(data, data + from->size(), value.begin());
    }

  private:
    scene::FieldMask mask_;
};

}  // namespace tessera::wire
