#include "client/export/glb_materials.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <glm/common.hpp>

#include "client/export/glb_text.h"
#include "mediator/picture/png_writer.h"

namespace tessera::exporting {
namespace {

using Object = tinygltf::Value::Object;
using tinygltf::Value;

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
    const auto [place, is_new] = materials_.try_emplace(id, 0);
    if (!is_new) return place->second;
    const auto* material = scene_.find_as<scene::Material>(id);
    tinygltf::Material made = make(material ? *material : scene::Material{.name = "default grey"});
    model_.materials.push_back(std::move(made));
    return place->second = static_cast<int>(model_.materials.size()) - 1;
}

tinygltf::Material GlbMaterials::make(const scene::Material& material) {
    tinygltf::Material made;
    made.name = utf8(material.name);
    tinygltf::PbrMetallicRoughness& pbr = made.pbrMetallicRoughness;
    pbr.baseColorFactor = {material.base_color.r, material.base_color.g, material.base_color.b,
                           material.base_color.a};
    fill(pbr.baseColorTexture, material.base_color_texture);
    pbr.metallicFactor = material.metallic;
    pbr.roughnessFactor = material.roughness;
    fill(pbr.metallicRoughnessTexture, material.metallic_roughness_texture);
    fill(made.normalTexture, material.normal_texture);
    made.normalTexture.scale = material.normal_scale;

    // glTF's factor ends at 1; what is brighter has its strength beside it.
    const glm::dvec3 emission(material.emission);
    const double strength = std::max({emission.r, emission.g, emission.b, 1.0});
    made.emissiveFactor = {emission.r / strength, emission.g / strength, emission.b / strength};
    if (strength > 1.0) {
        made.extensions["KHR_materials_emissive_strength"] =
            Value(Object{{"emissiveStrength", Value(strength)}});
        uses("KHR_materials_emissive_strength");
    }
    fill(made.emissiveTexture, material.emission_texture);
    made.alphaMode = alpha_mode(material.alpha_mode);
    made.alphaCutoff = material.alpha_cutoff;
    made.doubleSided = material.double_sided;
    if (material.unlit) {
        made.extensions["KHR_materials_unlit"] = Value(Object{});
        uses("KHR_materials_unlit");
    }
    if (material.index_of_refraction != 1.5f) {
        made.extensions["KHR_materials_ior"] =
            Value(Object{{"ior", Value(double{material.index_of_refraction})}});
        uses("KHR_materials_ior");
    }
    if (material.transmission > 0.0f) {
        made.extensions["KHR_materials_transmission"] =
            Value(Object{{"transmissionFactor", Value(double{material.transmission})}});
        uses("KHR_materials_transmission");
    }
    return made;
}

template <class Info>
void GlbMaterials::fill(Info& info, const scene::TextureSlot& slot) {
    const auto index = texture(slot.texture);
    if (!index) return;
    info.index = *index;
    if (slot == scene::TextureSlot{.texture = slot.texture}) return;
    info.extensions["KHR_texture_transform"] = Value(Object{{"offset", pair_of(slot.offset)},
                                                            {"scale", pair_of(slot.scale)},
                                                            {"rotation", Value(double{slot.rotation})}});
    uses("KHR_texture_transform");
}

std::optional<int> GlbMaterials::texture(ObjectId id) {
    if (!id) return std::nullopt;
    const auto [place, is_new] = textures_.try_emplace(id);
    const auto* texture = scene_.find_as<scene::Texture>(id);
    if (!is_new || texture == nullptr) return place->second;
    if (texture->format == scene::TexelFormat::RgbFloat) {
        notices_.insert("texture '" + texture->name +
                        "' is left out: glTF has no maps of floats; save the scene as .tessera to keep it");
        return std::nullopt;
    }
    tinygltf::Texture made;
    made.name = utf8(texture->name);
    made.source = image(*texture);
    made.sampler = sampler(*texture);
    model_.textures.push_back(std::move(made));
    return place->second = static_cast<int>(model_.textures.size()) - 1;
}

int GlbMaterials::image(const scene::Texture& texture) {
    const auto [place, is_new] = images_.try_emplace({texture.texels.hash, texture.width, texture.name}, 0);
    if (!is_new) return place->second;
    tinygltf::Image image;
    image.name = utf8(texture.name);
    image.mimeType = "image/png";
    image.bufferView = buffer_.view(picture::encode_rgba_png(
        texture.width, texture.height, buffer_.blob(texture.texels)->as<std::uint8_t>()));
    model_.images.push_back(std::move(image));
    return place->second = static_cast<int>(model_.images.size()) - 1;
}

int GlbMaterials::sampler(const scene::Texture& texture) {
    const auto [place, is_new] = samplers_.try_emplace({texture.wrap_s, texture.wrap_t, texture.filter}, 0);
    if (!is_new) return place->second;
    const bool nearest = texture.filter == scene::TextureFilter::Nearest;
    tinygltf::Sampler sampler;
    sampler.magFilter = nearest ? TINYGLTF_TEXTURE_FILTER_NEAREST : TINYGLTF_TEXTURE_FILTER_LINEAR;
    sampler.minFilter =
        nearest ? TINYGLTF_TEXTURE_FILTER_NEAREST : TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR;
    sampler.wrapS = wrap_mode(texture.wrap_s);
    sampler.wrapT = wrap_mode(texture.wrap_t);
    model_.samplers.push_back(std::move(sampler));
    return place->second = static_cast<int>(model_.samplers.size()) - 1;
}

}  // namespace tessera::exporting
