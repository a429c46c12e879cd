#pragma once

#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "mediator/scene/objects.h"

namespace tessera::scene {

// Which fields of a T are meant; bit i is T::Field(i). Typed, so that a mask of one kind cannot reach
// another.
template <class T>
class Fields {
  public:
    constexpr Fields() = default;
    constexpr Fields(typename T::Field field) : bits_(field_bit(static_cast<unsigned>(field))) {}
    constexpr Fields(std::initializer_list<typename T::Field> fields) {
        for (const auto field : fields) bits_ |= field_bit(static_cast<unsigned>(field));
    }
    static constexpr Fields from_bits(FieldMask bits) { return Fields(bits & all().bits_, 0); }
    static constexpr Fields all() {
        return Fields(field_bit(std::tuple_size_v<decltype(T::fields())>) - 1, 0);
    }
    constexpr FieldMask bits() const { return bits_; }
    constexpr bool empty() const { return bits_ == 0; }
    constexpr bool contains(typename T::Field field) const {
        return (bits_ >> static_cast<unsigned>(field)) & 1;
    }
    constexpr bool intersects(Fields other) const { return (bits_ & other.bits_) != 0; }
    constexpr Fields operator|(Fields other) const { return Fields(bits_ | other.bits_, 0); }
    friend constexpr bool operator==(Fields, Fields) = default;

  private:
    constexpr Fields(FieldMask bits, int) : bits_(bits) {}
    FieldMask bits_ = 0;
};

// Calls visit(bit index, pointer to member) for every field of T in the order of T::Field.
template <class T, class Visitor>
constexpr void for_each_field(Visitor&& visit) {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
        (visit(static_cast<unsigned>(I), std::get<I>(T::fields())), ...);
    }
    (std::make_index_sequence<std::tuple_size_v<decltype(T::fields())>>{});
}

// The untyped forms, for lists that hold all kinds. `from` must be of `to`'s kind (asserted).
FieldMask all_fields(const Object& object);
void assign(Object& to, const Object& from, FieldMask mask);
FieldMask differing_fields(const Object& a, const Object& b);
std::string_view field_name(ObjectKind kind, unsigned field);  // snake_case, as users type it

}  // namespace tessera::scene
