#include "client/import/gltf_extras.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "client/import/gltf_document.h"
#include "mediator/scene/fields.h"
#include "mediator/scene/validate_object.h"

namespace tessera::import {
namespace {

using tinygltf::Value;

constexpr const char* Lights[] = {"point", "spot", "directional", "sphere", "quad"};
constexpr const char* Projections[] = {"perspective", "orthographic"};
constexpr const char* Apertures[] = {"uniform", "gaussian"};
constexpr const char* AlphaModes[] = {"opaque", "mask", "blend"};
constexpr const char* NormalFormats[] = {"unorm", "snorm"};
constexpr const char* NormalSpaces[] = {"tangent", "object"};

// Each gives whether the value is of that type.
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
    const auto known = words<E>();
    const auto word = std::find(known.begin(), known.end(), from.IsString() ? from.Get<std::string>() : "");
    if (word != known.end()) value = static_cast<E>(word - known.begin());
    return word != known.end();
}

template <class T>
TextureUse use_in(unsigned field) {
    if constexpr (std::is_same_v<T, scene::SurfaceShader> || std::is_same_v<T, scene::Medium>)
        return use_of(static_cast<typename T::Field>(field));
    return TextureUse::Color;
}

// "light 0 ('lamp'): the radius ..." without whose it is.
std::string cause_of(const std::string& problem) {
    const std::size_t colon =
        problem.find("): ") != std::string::npos ? problem.find("): ") + 1 : problem.find(": ");
    return colon == std::string::npos ? problem : problem.substr(colon + 2);
}

}  // namespace

template <>
std::span<const char* const> words<scene::LightKind>() {
    return Lights;
}
template <>
std::span<const char* const> words<scene::Projection>() {
    return Projections;
}
template <>
std::span<const char* const> words<scene::Aperture>() {
    return Apertures;
}
template <>
std::span<const char* const> words<scene::AlphaMode>() {
    return AlphaModes;
}
template <>
std::span<const char* const> words<scene::NormalFormat>() {
    return NormalFormats;
}
template <>
std::span<const char* const> words<scene::NormalSpace>() {
    return NormalSpaces;
}

const Value* object_extras(const Value& extras, const char* name) {
    if (!extras.IsObject() || !extras.Has(name)) return nullptr;
    const Value& found = extras.Get(name);
    return found.IsObject() ? &found : nullptr;
}

TextureUse use_of(scene::SurfaceShader::Field field) {
    using enum scene::SurfaceShader::Field;
    const bool is_data = field == ShininessTexture || field == AlphaTexture || field == NormalTexture ||
                         field == HeightTexture;
    return is_data ? TextureUse::Data : TextureUse::Color;
}

TextureUse use_of(scene::Medium::Field field) {
    using enum scene::Medium::Field;
    return field == AbsorptionTexture || field == ScatteringTexture ? TextureUse::Data : TextureUse::Color;
}

template <class T>
void read_extras(const Value& from, T& object, const std::string& owner, SceneBuilder& builder,
                 const ReadSlot& read_slot) {
    std::set<std::string> unknown;
    for (const std::string& name : from.Keys()) unknown.insert(name);
    scene::for_each_field<T>([&](unsigned field, auto member) {
        const std::string name(scene::field_name(scene::kind(scene::Object(object)), field));
        if (unknown.erase(name) == 0) return;
        T candidate = object;
        bool fits = false;
        if constexpr (std::is_same_v<std::decay_t<decltype(candidate.*member)>, scene::TextureSlot>) {
            fits = from.Get(name).IsObject() && read_slot != nullptr;
            if (fits) candidate.*member = read_slot(from, name.c_str(), use_in<T>(field));
        } else {
            fits = read(from.Get(name), candidate.*member);
        }
        const auto problems = scene::problems_of({}, candidate);
        if (fits && problems.empty()) {
            object = std::move(candidate);
            return;
        }
        builder.notice(owner + ": its " + name + " cannot be used (" +
                       (fits ? cause_of(problems.front()) : "it is of another type") +
                       "): its default is used, correct it");
    });
    if (unknown.empty()) return;
    builder.notice(owner + ": its extras have no field '" + unknown.begin()->substr(0, 40) + "'" +
                   (unknown.size() > 1 ? " and " + std::to_string(unknown.size() - 1) + " others" : "") +
                   ": what they say is ignored");
}

template void read_extras(const Value&, scene::Light&, const std::string&, SceneBuilder&, const ReadSlot&);
template void read_extras(const Value&, scene::Camera&, const std::string&, SceneBuilder&, const ReadSlot&);
template void read_extras(const Value&, scene::Material&, const std::string&, SceneBuilder&, const ReadSlot&);
template void read_extras(const Value&, scene::SurfaceShader&, const std::string&, SceneBuilder&,
                          const ReadSlot&);
template void read_extras(const Value&, scene::Medium&, const std::string&, SceneBuilder&, const ReadSlot&);

}  // namespace tessera::import
