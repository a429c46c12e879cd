#pragma once

#include <type_traits>
#include <utility>

#include "mediator/scene/fields.h"
#include "mediator/scene/objects.h"

namespace tessera::scene {

// Calls visit(id) for every reference in the fields of an object, null references (0) included. For a non-const
// object `visit` gets them by reference and may change them.
template <class O, class Visitor>
requires std::is_same_v<std::remove_const_t<O>, Object>
void for_each_reference(O& object, Visitor&& visit) {
    const auto field = [&]<class V>(V& value) {
        using Plain = std::remove_const_t<V>;
        if constexpr (std::is_same_v<Plain, ObjectId>) {
            visit(value);
        } else if constexpr (std::is_same_v<Plain, std::vector<ObjectId>>) {
            for (auto& id : value) visit(id);
        } else if constexpr (std::is_same_v<Plain, TextureSlot>) {
            visit(value.texture);
        }
    };
    std::visit(
        [&]<class T>(T& value) {
            for_each_field<std::remove_const_t<T>>([&](unsigned, auto member) { field(value.*member); });
        },
        object);
}

}  // namespace tessera::scene
