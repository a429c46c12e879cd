#include "client/export/glb_materials.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <glm/common.hpp>

#include "client/export/glb_extras.h"
#include "client/export/glb_text.h"
#include "client/export/nearest_material.h"
#include "client/import/gltf_extensions.h"
#include "client/import/gltf_extras.h"
#include "mediator/picture/png_writer.h"

namespace tessera::exporting {
namespace {

using Object = tinygltf::Value::Object;
using tinygltf::Value;

bool is_within_one(std::span<const float> values) {
    return std::all_of(values.begin(), values.end(), [](float v) { return v >= 0.0f && v <= 1.0f; });
}

Value pair_of(const glm::vec2& value) {
    return Value(Value::Array{Value(double{value.x}), Value(double{value.y})});
}

int wrap_mode(scene::Wrap wrap) {
    switch (wrap) {
        case scene::Wrap::Repeat:
            return TINYGLTF_TEXTURE_WRAP_REPEAT;
        case scene::Wrap::Mirror:
            return TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT;
        case scene::Wrap::Clamp:
            return TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    }
    return TINYGLTF_TEXTURE_WRAP_REPEAT;
}

const char* alpha_mode(scene::AlphaMode mode) {
    switch (mode) {
        case scene::AlphaMode::Opaque:
            return "OPAQUE";
        case scene::AlphaMode::Mask:
            return "MASK";
        case scene::AlphaMode::Blend:
            return "BLEND";
    }
    return "OPAQUE";
}

}  // namespace

void GlbMaterials::uses(const char* extension) {
    auto& used = model_.extensionsUsed;
    if (std::find(used.begin(), used.end(), extension) == used.end()) used.push_back(extension);
}

int GlbMaterials::material(ObjectId id) {
    const auto [entry, is_new] = materials_.try_emplace(id, 0);
    if (!is_new) return entry->second;
    const auto* material = scene_.find_as<scene::Material>(id);
    const auto* shader = scene_.find_as<scene::SurfaceShader>(id);
    tinygltf::Material result = shader     ? make(*shader)
                                : material ? make(*material)
                                           : make(scene::Material{.name = "default grey"});
    model_.materials.push_back(std::move(result));
    return entry->second = static_cast<int>(model_.materials.size()) - 1;
}

int GlbMaterials::medium(ObjectId id) {
    const auto* medium = scene_.find_as<scene::Medium>(id);
    if (medium == nullptr) return -1;
    const auto [entry, is_new] = media_.try_emplace(id, static_cast<int>(media_.size()));
    if (is_new) {
        Object extras = model_.extras.IsObject() ? model_.extras.Get<Object>() : Object{};
        Value::Array media = extras.contains(import::MediaExtras)
                                 ? extras[import::MediaExtras].Get<Value::Array>()
                                 : Value::Array{};
        media.push_back(extras_of(*medium, scene::Fields<scene::Medium>::all(), slots()));
        extras[import::MediaExtras] = Value(std::move(media));
        model_.extras = Value(std::move(extras));
    }
    return entry->second;
}

WriteSlot GlbMaterials::slots() {
    return [this](const scene::TextureSlot& slot) { return info_of(slot); };
}

tinygltf::Material GlbMaterials::make(const scene::SurfaceShader& shader) {
    tinygltf::Material result = make(nearest_material(shader));
    // All fields but the name, which is that of the material.
    const auto fields = scene::Fields<scene::SurfaceShader>::from_bits(
        ~scene::Fields<scene::SurfaceShader>(&scene::SurfaceShader::name).bits());
    result.extras = Value(Object{{import::ShaderExtras, extras_of(shader, fields, slots())}});
    return result;
}

tinygltf::Material GlbMaterials::make(const scene::Material& material) {
    tinygltf::Material result;
    result.name = utf8(material.name);
    tinygltf::PbrMetallicRoughness& pbr = result.pbrMetallicRoughness;
    pbr.baseColorFactor = {material.base_color.r, material.base_color.g, material.base_color.b,
                           material.base_color.a};
    fill(pbr.baseColorTexture, material.base_color_texture);
    pbr.metallicFactor = material.metallic;
    pbr.roughnessFactor = material.roughness;
    fill(pbr.metallicRoughnessTexture, material.metallic_roughness_texture);
    fill(result.normalTexture, material.normal_texture);
    result.normalTexture.scale = material.normal_scale;

    // glTF limits the factor to 1; brighter emission needs a strength.
    const glm::dvec3 emission(material.emission);
    const double strength = std::max({emission.r, emission.g, emission.b, 1.0});
    result.emissiveFactor = {emission.r / strength, emission.g / strength, emission.b / strength};
    if (strength > 1.0) {
        result.extensions["KHR_materials_emissive_strength"] =
            Value(Object{{"emissiveStrength", Value(strength)}});
        uses("KHR_materials_emissive_strength");
    }
    fill(result.emissiveTexture, material.emission_texture);
    result.alphaMode = alpha_mode(material.alpha_mode);
    result.alphaCutoff = material.alpha_cutoff;
    result.doubleSided = material.double_sided;
    add_extensions(result, material);
    const auto own = scene::Fields<scene::Material>::from_bits(
        scene::Fields<scene::Material>::with<scene::GltfExtras>().bits() &
        changed_fields(material, scene::Material{}).bits());
    if (!own.empty())
        result.extras = Value(Object{{import::MaterialExtras, extras_of(material, own, slots())}});
    return result;
}

template <class Info>
void GlbMaterials::fill(Info& info, const scene::TextureSlot& slot) {
    const auto index = texture(slot.texture);
    if (!index) return;
    info.index = *index;
    info.texCoord = static_cast<int>(slot.set);
    if (const auto transform = transform_of(slot)) info.extensions["KHR_texture_transform"] = *transform;
}

std::optional<Value> GlbMaterials::transform_of(const scene::TextureSlot& slot) {
    if (slot == scene::TextureSlot{.texture = slot.texture, .set = slot.set}) return std::nullopt;
    uses("KHR_texture_transform");
    return Value(Object{{"offset", pair_of(slot.offset)},
                        {"scale", pair_of(slot.scale)},
                        {"rotation", Value(double{slot.rotation})}});
}

std::optional<Value> GlbMaterials::info_of(const scene::TextureSlot& slot, float scale) {
    const auto index = texture(slot.texture);
    if (!index) return std::nullopt;
    Object info{{"index", Value(*index)}};
    if (slot.set != 0) info["texCoord"] = Value(static_cast<int>(slot.set));
    if (scale != 1.0f) info["scale"] = Value(double{scale});
    if (const auto transform = transform_of(slot)) {
        info["extensions"] = Value(Object{{"KHR_texture_transform", *transform}});
    }
    return Value(std::move(info));
}

// Only values that differ from the default.
void GlbMaterials::add_extensions(tinygltf::Material& result, const scene::Material& material) {
    std::map<std::string, Object> extensions;
    if (material.unlit) extensions["KHR_materials_unlit"] = {};
    for (const import::GltfMember& member : import::gltf_members()) {
        std::optional<Value> value;
        if (const auto* color = std::get_if<glm::vec3 scene::Material::*>(&member.field)) {
            const glm::vec3& v = material.*(*color);
            if (v != scene::Material{}.*(*color))
                value = Value(Value::Array{Value(double{v.x}), Value(double{v.y}), Value(double{v.z})});
        } else if (const auto* factor = std::get_if<float scene::Material::*>(&member.field)) {
            if (material.*(*factor) != scene::Material{}.*(*factor))
                value = Value(double{material.*(*factor)});
        } else {
            const auto field = std::get<scene::TextureSlot scene::Material::*>(member.field);
            const bool is_coat = field == &scene::Material::clearcoat_normal_texture;
            value = info_of(material.*field, is_coat ? material.clearcoat_normal_scale : 1.0f);
        }
        if (value) extensions[member.extension][member.name] = *value;
    }
    for (auto& [name, members] : extensions) {
        result.extensions[name] = Value(std::move(members));
        uses(name.c_str());
    }
}

std::optional<int> GlbMaterials::texture(ObjectId id) {
    if (!id) return std::nullopt;
    const auto [entry, is_new] = textures_.try_emplace(id);
    const auto* texture = scene_.find_as<scene::Texture>(id);
    if (!is_new || texture == nullptr) return entry->second;
    const bool is_float = texture->format == scene::TexelFormat::RgbFloat;
    if (is_float && !is_within_one(buffer_.blob(texture->texels)->as<float>())) {
        notices_.insert(
            "texture '" + texture->name +
            "' is left out: glTF has no textures with values above 1; save the scene as .tessera to keep it");
        return std::nullopt;
    }
    tinygltf::Texture result;
    result.name = utf8(texture->name);
    result.source = image(*texture);
    if (texture->depth > 1)
        result.extras = Value(Object{{import::DepthExtras, Value(static_cast<int>(texture->depth))}});
    result.sampler = sampler(*texture);
    model_.textures.push_back(std::move(result));
    return entry->second = static_cast<int>(model_.textures.size()) - 1;
}

int GlbMaterials::image(const scene::Texture& texture) {
    const auto [entry, is_new] = images_.try_emplace({texture.texels.hash, texture.width, texture.name}, 0);
    if (!is_new) return entry->second;
    tinygltf::Image image;
    image.name = utf8(texture.name);
    image.mimeType = "image/png";
    const scene::BlobPtr texels = buffer_.blob(texture.texels);
    const std::uint32_t height = texture.height * texture.depth;
    image.bufferView =
        buffer_.view(texture.format == scene::TexelFormat::RgbFloat
                         ? picture::encode_png16(texture.width, height, texels->as<float>())
                         : picture::encode_rgba_png(texture.width, height, texels->as<std::uint8_t>()));
    model_.images.push_back(std::move(image));
    return entry->second = static_cast<int>(model_.images.size()) - 1;
}

int GlbMaterials::sampler(const scene::Texture& texture) {
    const auto [entry, is_new] = samplers_.try_emplace({texture.wrap_s, texture.wrap_t, texture.filter}, 0);
    if (!is_new) return entry->second;
    const bool nearest = texture.filter == scene::TextureFilter::Nearest;
    tinygltf::Sampler sampler;
    sampler.magFilter = nearest ? TINYGLTF_TEXTURE_FILTER_NEAREST : TINYGLTF_TEXTURE_FILTER_LINEAR;
    sampler.minFilter =
        nearest ? TINYGLTF_TEXTURE_FILTER_NEAREST : TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR;
    sampler.wrapS = wrap_mode(texture.wrap_s);
    sampler.wrapT = wrap_mode(texture.wrap_t);
    model_.samplers.push_back(std::move(sampler));
    return entry->second = static_cast<int>(model_.samplers.size()) - 1;
}

}  // namespace tessera::exporting
