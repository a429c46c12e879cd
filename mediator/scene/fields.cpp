#include "mediator/scene/fields.h"

#include <algorithm>
#include <cassert>

#include "mediator/scene/field_values.h"

namespace tessera::scene {

FieldMask all_fields(const Object& object) {
    return std::visit([]<class T>(const T&) { return Fields<T>::all().bits(); }, object);
}

FieldMask all_fields(ObjectKind kind) {
    FieldMask mask = 0;
    with_kind(kind, [&]<class T>() { mask = Fields<T>::all().bits(); });
    return mask;
}

void assign(Object& to, const Object& from, FieldMask mask) {
    assert(to.index() == from.index());
    std::visit(
        [&]<class T>(T& target) {
            const T& source = std::get<T>(from);
            for_each_field<T>([&](unsigned index, auto member) {
                if ((mask & field_bit(index)) != 0) target.*member = source.*member;
            });
        },
        to);
}

FieldMask differing_fields(const Object& a, const Object& b) {
    assert(a.index() == b.index());
    FieldMask mask = 0;
    std::visit(
        [&]<class T>(const T& left) {
            const T& right = std::get<T>(b);
            for_each_field<T>([&](unsigned index, auto member) {
                if (!same_bits(left.*member, right.*member)) mask |= field_bit(index);
            });
        },
        a);
    return mask;
}

std::string_view field_name(ObjectKind kind, unsigned field) {
    std::string_view name;
    with_kind(kind, [&]<class T>() {
        for_each_row<T>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
            if (row_of<T, I>.number - 1 == field) name = row_of<T, I>.name;
        });
    });
    return name;
}

}  // namespace tessera::scene
