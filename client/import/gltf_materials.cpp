#include "client/import/gltf_materials.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>

#include "client/import/gltf_extensions.h"
#include "client/import/gltf_extras.h"
#include "client/import/gltf_slots.h"
#include "mediator/scene/fields.h"

namespace tessera::import {
namespace {

constexpr double MaxEmission = 1e12;

// Numbers of materials were validated before parsing (check_gltf_materials).
float number(double value) {
    return static_cast<float>(value);
}

void read_extensions(const tinygltf::ExtensionMap& source, GltfSlots& slots, scene::Material& material) {
    material.unlit = gltf_extension(source, "KHR_materials_unlit") != nullptr;
    for (const GltfMember& member : gltf_members()) {
        const tinygltf::Value* extension = gltf_extension(source, member.extension);
        if (extension == nullptr || !extension->IsObject()) continue;
        if (const auto* color = std::get_if<glm::vec3 scene::Material::*>(&member.field)) {
            const std::vector<double> given = number_array(*extension, member.name);
            for (glm::length_t i = 0; given.size() == 3 && i < 3; ++i)
                (material.*(*color))[i] = number(given[static_cast<std::size_t>(i)]);
        } else if (const auto* factor = std::get_if<float scene::Material::*>(&member.field)) {
            float& value = material.*(*factor);
            value = number(number_member(*extension, member.name, double{value}));
        } else {
            const auto field = std::get<scene::TextureSlot scene::Material::*>(member.field);
            material.*field = slots.slot(*extension, member.name, use_of(field));
        }
    }
    const tinygltf::Value* coat = gltf_extension(source, "KHR_materials_clearcoat");
    if (coat == nullptr || !coat->Has("clearcoatNormalTexture")) return;
    const tinygltf::Value& map = coat->Get("clearcoatNormalTexture");
    if (map.IsObject()) material.clearcoat_normal_scale = number(number_member(map, "scale", 1.0));
}

}  // namespace

GltfMaterial GltfMaterials::material(int index) {
    if (index < -1 || index >= static_cast<int>(model_.materials.size())) {
        builder_.notice("material " + std::to_string(index) + " is missing: the default one is used");
        index = -1;
    }
    const auto found = materials_.find(index);
    if (found != materials_.end()) return found->second;
    const GltfMaterial result = index < 0 ? make(tinygltf::Material(), "default")
                                          : make(model_.materials[static_cast<std::size_t>(index)],
                                                 "material " + std::to_string(index));
    materials_[index] = result;
    return result;
}

namespace {

template <class T>
bool uses_tex_coords_1(const T& material) {
    bool uses = false;
    scene::for_each_field<T>([&](unsigned, auto member) {
        if constexpr (std::is_same_v<std::decay_t<decltype(material.*member)>, scene::TextureSlot>) {
            uses |= (material.*member).texture && (material.*member).set == 1;
        }
    });
    return uses;
}

}  // namespace

GltfMaterial GltfMaterials::make_shader(const tinygltf::Value& fields, const std::string& name) {
    scene::SurfaceShader shader;
    shader.name = name;
    GltfSlots slots(textures_, name);
    read_extras(fields, shader, "material '" + name + "'", builder_, slots.reader());
    GltfMaterial result;
    result.needs_tangents = shader.normal_texture.texture || shader.height_texture.texture ||
                            shader.shininess.x != shader.shininess.y;
    result.tangent_set = shader.normal_texture.set;
    result.needs_tex_coords_1 =
        uses_tex_coords_1(shader) || shader.tangent_tex_coords == 1 || shader.binormal_tex_coords == 1;
    result.id = builder_.add(std::move(shader));
    return result;
}

ObjectId GltfMaterials::thin_walled(ObjectId id) {
    const auto [entry, is_new] = thin_walled_.try_emplace(id);
    if (!is_new) return entry->second;
    scene::Material material = builder_.get<scene::Material>(id);
    if (material.attenuation_distance > 0.0f) {
        const float lengths = material.thickness / material.attenuation_distance;
        for (int i = 0; i < 3; ++i)
            material.base_color[i] *= std::pow(material.attenuation_color[i], lengths);
    }
    material.name += " (thin-walled)";
    material.thickness = 0.0f;
    material.attenuation_distance = scene::Material{}.attenuation_distance;
    material.attenuation_color = scene::Material{}.attenuation_color;
    return entry->second = builder_.add(std::move(material));
}

ObjectId GltfMaterials::medium(const tinygltf::Value& primitive_extras) {
    if (!primitive_extras.IsObject() || !primitive_extras.Has(MediumExtras)) return {};
    const int index = index_member(primitive_extras, MediumExtras);
    const auto [entry, is_new] = media_.try_emplace(index);
    if (!is_new) return entry->second;
    const std::string fallback = "medium " + std::to_string(index);
    const tinygltf::Value none;
    const tinygltf::Value& media =
        model_.extras.IsObject() && model_.extras.Has(MediaExtras) ? model_.extras.Get(MediaExtras) : none;
    if (index < 0 || !media.IsArray() || static_cast<std::size_t>(index) >= media.ArrayLen() ||
        !media.Get(index).IsObject()) {
        builder_.notice(fallback + " is missing: the meshes that use it have no interior medium");
        return {};
    }
    scene::Medium medium;
    GltfSlots slots(textures_, fallback);
    read_extras(media.Get(index), medium, fallback, builder_, slots.reader());
    return entry->second = builder_.add(std::move(medium));
}

GltfMaterial GltfMaterials::make(const tinygltf::Material& source, const std::string& fallback_name) {
    const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
    scene::Material material;
    material.name = source.name.empty() ? fallback_name : source.name;
    const std::string name = material.name;
    if (const auto* shader = object_extras(source.extras, ShaderExtras)) return make_shader(*shader, name);
    GltfSlots slots(textures_, name);
    for (int i = 0; i < 4; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const double value = pbr.baseColorFactor.size() == 4 ? pbr.baseColorFactor[k] : 1.0;
        material.base_color[i] = number(value);
    }
    material.base_color_texture = slots.slot(pbr.baseColorTexture, TextureUse::Color);
    material.metallic = number(pbr.metallicFactor);
    material.roughness = number(pbr.roughnessFactor);
    material.metallic_roughness_texture = slots.slot(pbr.metallicRoughnessTexture, TextureUse::Data);
    material.normal_texture = slots.slot(source.normalTexture, TextureUse::Data);
    material.normal_scale = number(source.normalTexture.scale);

    double strength = 1.0;
    if (const auto* found = gltf_extension(source.extensions, "KHR_materials_emissive_strength")) {
        strength = number_member(*found, "emissiveStrength", 1.0);
    }
    for (int i = 0; i < 3; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const double factor = source.emissiveFactor.size() == 3 ? source.emissiveFactor[k] : 0.0;
        material.emission[i] = number(std::min(factor * strength, MaxEmission));
    }
    if (material.emission != glm::vec3(0.0f)) {
        material.emission_texture = slots.slot(source.emissiveTexture, TextureUse::Color);
    }
    if (source.alphaMode == "MASK") material.alpha_mode = scene::AlphaMode::Mask;
    if (source.alphaMode == "BLEND") material.alpha_mode = scene::AlphaMode::Blend;
    material.alpha_cutoff = number(source.alphaCutoff);
    material.double_sided = source.doubleSided;
    read_extensions(source.extensions, slots, material);
    if (const auto* own = object_extras(source.extras, MaterialExtras))
        read_extras(*own, material, "material '" + name + "'", builder_, slots.reader());
    if (material.transmission > 0.0f &&
        gltf_extension(source.extensions, "KHR_materials_volume") == nullptr) {
        if (builder_.options().glass == Glass::Solid) {
            material.thickness = 1.0f;
        } else {
            builder_.notice("material '" + material.name +
                            "' is transmissive without KHR_materials_volume: it is rendered thin-walled, as "
                            "glTF specifies; --solid-glass renders it as solid, refracting glass");
        }
    }
    if (slots.has_unsupported_set()) {
        builder_.notice(
            "material '" + material.name +
            "': its textures use more than two sets of coordinates; the second is used for the others");
    }
    GltfMaterial result;
    result.needs_tangents = material.normal_texture.texture || material.clearcoat_normal_texture.texture ||
                            material.anisotropy > 0.0f;
    result.tangent_set =
        material.normal_texture.texture ? material.normal_texture.set : material.clearcoat_normal_texture.set;
    result.needs_tex_coords_1 = uses_tex_coords_1(material);
    const bool has_volume = material.transmission > 0.0f && material.thickness > 0.0f &&
                            gltf_extension(source.extensions, "KHR_materials_volume") != nullptr;
    result.id = builder_.add(std::move(material));
    if (has_volume) volumes_.insert(result.id);
    return result;
}

}  // namespace tessera::import
