#include "client/export/glb_extras.h"

#include <tiny_gltf.h>

#include <string>

#include "client/export/glb_text.h"

namespace tessera::exporting {
namespace {

using tinygltf::Value;

Value value_of(const std::string& text) {
    return Value(utf8(text));
}
Value value_of(bool flag) {
    return Value(flag);
}
Value value_of(std::int32_t number) {
    return Value(number);
}
Value value_of(double number) {
    return Value(number);
}
template <glm::length_t N>
Value value_of(const glm::vec<N, float>& numbers) {
    Value::Array array;
    for (glm::length_t i = 0; i < N; ++i) array.emplace_back(double{numbers[i]});
    return Value(std::move(array));
}
template <class E>
requires std::is_enum_v<E> Value value_of(E value) {
    return Value(std::string(enumerator_name(value)));
}

}  // namespace

template <class T>
Value extras_of(const T& object, scene::Fields<T> mask, const WriteSlot& write_slot) {
    Value::Object members;
    for_each_row<T>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
        constexpr auto& row = row_of<T, I>;
        if (!mask.contains(row.access)) return;
        const auto& value = row.of(object);
        const std::string name(row.name);
        if constexpr (std::is_same_v<std::decay_t<decltype(value)>, scene::TextureSlot>) {
            if (auto slot = write_slot ? write_slot(value) : std::nullopt) members[name] = *slot;
        } else {
            members[name] = value_of(value);
        }
    });
    return Value(std::move(members));
}

template <class T>
scene::Fields<T> changed_fields(const T& object, const T& otherwise) {
    return scene::Fields<T>::from_bits(
        scene::differing_fields(scene::Object(object), scene::Object(otherwise)));
}

template Value extras_of(const scene::Light&, scene::Fields<scene::Light>, const WriteSlot&);
template Value extras_of(const scene::Camera&, scene::Fields<scene::Camera>, const WriteSlot&);
template Value extras_of(const scene::Material&, scene::Fields<scene::Material>, const WriteSlot&);
template Value extras_of(const scene::SurfaceShader&, scene::Fields<scene::SurfaceShader>, const WriteSlot&);
template Value extras_of(const scene::Medium&, scene::Fields<scene::Medium>, const WriteSlot&);
template scene::Fields<scene::Light> changed_fields(const scene::Light&, const scene::Light&);
template scene::Fields<scene::Material> changed_fields(const scene::Material&, const scene::Material&);
template scene::Fields<scene::Camera> changed_fields(const scene::Camera&, const scene::Camera&);

}  // namespace tessera::exporting
