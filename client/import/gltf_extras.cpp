#include "client/import/gltf_extras.h"

#include <tiny_gltf.h>

#include <set>

#include "client/import/gltf_document.h"
#include "mediator/scene/fields.h"
#include "mediator/scene/validate_object.h"

namespace tessera::import {
namespace {

using tinygltf::Value;

// Return whether the value is of that type.
bool read(const Value& from, std::string& value) {
    if (from.IsString()) value = from.Get<std::string>();
    return from.IsString();
}
bool read(const Value& from, bool& value) {
    if (from.IsBool()) value = from.Get<bool>();
    return from.IsBool();
}
bool read(const Value& from, std::int32_t& value) {
    if (from.IsInt()) value = from.GetNumberAsInt();
    return from.IsInt();
}
bool read(const Value& from, double& value) {
    if (from.IsNumber()) value = from.GetNumberAsDouble();
    return from.IsNumber();
}
bool read(const Value& from, float& value) {
    double number = 0.0;
    if (!read(from, number)) return false;
    value = static_cast<float>(number);
    return true;
}
template <glm::length_t N>
bool read(const Value& from, glm::vec<N, float>& value) {
    if (!from.IsArray() || from.ArrayLen() != std::size_t{N}) return false;
    bool fits = true;
    for (glm::length_t i = 0; i < N; ++i) fits = read(from.Get(static_cast<int>(i)), value[i]) && fits;
    return fits;
}
template <class E>
requires std::is_enum_v<E>
bool read(const Value& from, E& value) {
    const auto named = enumerator_named<E>(from.IsString() ? from.Get<std::string>() : "");
    if (named) value = *named;
    return named.has_value();
}

}  // namespace

const Value* object_extras(const Value& extras, const char* name) {
    if (!extras.IsObject() || !extras.Has(name)) return nullptr;
    const Value& found = extras.Get(name);
    return found.IsObject() ? &found : nullptr;
}

template <class T>
void read_extras(const Value& from, T& object, const std::string& owner, SceneBuilder& builder,
                 const ReadSlot& read_slot) {
    std::set<std::string> unknown;
    for (const std::string& name : from.Keys()) unknown.insert(name);
    for_each_row<T>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
        constexpr auto& row = row_of<T, I>;
        const std::string name(row.name);
        if (unknown.erase(name) == 0) return;
        T candidate = object;
        auto& value = row.of(candidate);
        bool fits = false;
        if constexpr (std::is_same_v<std::decay_t<decltype(value)>, scene::TextureSlot>) {
            using Row = std::decay_t<decltype(row)>;
            constexpr TextureUse use =
                Row::template has<scene::DataTexels> ? TextureUse::Data : TextureUse::Color;
            fits = from.Get(name).IsObject() && read_slot != nullptr;
            if (fits) value = read_slot(from, name.c_str(), use);
        } else {
            fits = read(from.Get(name), value);
        }
        const auto causes = scene::causes_of(candidate);
        if (fits && causes.empty()) {
            object = std::move(candidate);
            return;
        }
        builder.notice(owner + ": its " + name + " cannot be used (" +
                       (fits ? causes.front() : "it is of another type") +
                       "): its default is used, correct it");
    });
    if (unknown.empty()) return;
    builder.notice(owner + ": its extras have no field '" + unknown.begin()->substr(0, 40) + "'" +
                   (unknown.size() > 1 ? " and " + std::to_string(unknown.size() - 1) + " others" : "") +
                   ": these are ignored");
}

template void read_extras(const Value&, scene::Light&, const std::string&, SceneBuilder&, const ReadSlot&);
template void read_extras(const Value&, scene::Camera&, const std::string&, SceneBuilder&, const ReadSlot&);
template void read_extras(const Value&, scene::Material&, const std::string&, SceneBuilder&, const ReadSlot&);
template void read_extras(const Value&, scene::SurfaceShader&, const std::string&, SceneBuilder&,
                          const ReadSlot&);
template void read_extras(const Value&, scene::Medium&, const std::string&, SceneBuilder&, const ReadSlot&);

}  // namespace tessera::import
