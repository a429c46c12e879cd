#pragma once

#include <cstdlib>
#include <string_view>
#include <type_traits>
#include <utility>

#include "mediator/scene/objects.h"

namespace tessera::scene {

// Calls visit(index, pointer to member) for every field of T, in the order of its rows. The index, number - 1,
// is that of the field's bit in a mask.
template <class T, class Visitor>
constexpr void for_each_field(Visitor&& visit) {
    for_each_row<T>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
        visit(row_of<T, I>.number - 1, row_of<T, I>.access);
    });
}

// A typed set of fields of T, so that masks of different kinds cannot be mixed up.
template <class T>
class Fields {
  public:
    constexpr Fields() = default;
    template <class... V>
    requires(sizeof...(V) > 0) constexpr Fields(V T::*... members) : bits_((bit_of(members) | ...)) {}
    static constexpr Fields from_bits(FieldMask bits) { return Fields(bits & all().bits_, 0); }
    static constexpr Fields all() {
        FieldMask bits = 0;
        for_each_field<T>([&](unsigned index, auto) { bits |= field_bit(index); });
        return Fields(bits, 0);
    }
    // The fields whose rows have this note.
    template <class Note>
    static constexpr Fields with() {
        FieldMask bits = 0;
        for_each_row<T>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
            if (std::decay_t<decltype(row_of<T, I>)>::template has<Note>)
                bits |= field_bit(row_of<T, I>.number - 1);
        });
        return Fields(bits, 0);
    }
    constexpr FieldMask bits() const { return bits_; }
    constexpr bool empty() const { return bits_ == 0; }
    constexpr bool contains(Fields other) const { return (bits_ & other.bits_) == other.bits_; }
    constexpr bool intersects(Fields other) const { return (bits_ & other.bits_) != 0; }
    constexpr Fields operator|(Fields other) const { return Fields(bits_ | other.bits_, 0); }
    friend constexpr bool operator==(Fields, Fields) = default;

  private:
    constexpr Fields(FieldMask bits, int) : bits_(bits) {}
    template <class V>
    static constexpr FieldMask bit_of(V T::*member) {
        FieldMask bit = 0;
        for_each_field<T>([&](unsigned index, auto candidate) {
            if constexpr (std::is_same_v<decltype(candidate), V T::*>) {
                if (candidate == member) bit = field_bit(index);
            }
        });
        if (bit == 0) std::abort();  // a member without a row; does not compile in a constant expression
        return bit;
    }

    FieldMask bits_ = 0;
};

// Calls visit.template operator()<T>() for the structure of this kind.
template <class Visitor>
void with_kind(ObjectKind kind, Visitor&& visit) {
    const auto visit_kind = [&]<class... T>(const std::variant<T...>*) {
        ((T::Kind.kind == kind ? visit.template operator()<T>() : void()), ...);
    };
    visit_kind(static_cast<const Object*>(nullptr));
}

// Untyped versions, for objects of any kind. `from` must have the kind of `to` (asserted).
FieldMask all_fields(const Object& object);
FieldMask all_fields(ObjectKind kind);
void assign(Object& to, const Object& from, FieldMask mask);
FieldMask differing_fields(const Object& a, const Object& b);
// snake_case, as users type it; "" if there is no field with this index.
std::string_view field_name(ObjectKind kind, unsigned field);

}  // namespace tessera::scene
