#include "client/export/glb_materials.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <glm/common.hpp>

#include "client/export/glb_extras.h"
#include "client/export/glb_text.h"
#include "client/export/nearest_material.h"
#include "client/import/gltf_extras.h"
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
    const auto* shader = scene_.find_as<scene::SurfaceShader>(id);
    tinygltf::Material made = shader     ? make(*shader)
                              : material ? make(*material)
                                         : make(scene::Material{.name = "default grey"});
    model_.materials.push_back(std::move(made));
    return place->second = static_cast<int>(model_.materials.size()) - 1;
}

int GlbMaterials::medium(ObjectId id) {
    const auto* medium = scene_.find_as<scene::Medium>(id);
    if (medium == nullptr) return -1;
    const auto [place, is_new] = media_.try_emplace(id, static_cast<int>(media_.size()));
    if (is_new) {
        Object extras = model_.extras.IsObject() ? model_.extras.Get<Object>() : Object{};
        Value::Array media = extras.contains(import::MediaExtras)
                                 ? extras[import::MediaExtras].Get<Value::Array>()
                                 : Value::Array{};
        media.push_back(extras_of(*medium, scene::Fields<scene::Medium>::all(), slots()));
        extras[import::MediaExtras] = Value(std::move(media));
        model_.extras = Value(std::move(extras));
    }
    return place->second;
}

WriteSlot GlbMaterials::slots() {
    return [this](const scene::TextureSlot& slot) { return info_of(slot); };
}

tinygltf::Material GlbMaterials::make(const scene::SurfaceShader& shader) {
    using Field = scene::SurfaceShader::Field;
    tinygltf::Material made = make(nearest_material(shader));
    // All but the name: it stands in the material.
    const auto all = scene::Fields<scene::SurfaceShader>::all().bits() &
                     ~scene::field_bit(static_cast<unsigned>(Field::Name));
    const auto fields = scene::Fields<scene::SurfaceShader>::from_bits(all);
    made.extras = Value(Object{{import::ShaderExtras, extras_of(shader, fields, slots())}});
    return made;
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
    add_extensions(made, material);
    if (material.shadow_catcher) {
        using Field = scene::Material::Field;
        made.extras = Value(
            Object{{import::MaterialExtras, extras_of<scene::Material>(material, Field::ShadowCatcher)}});
    }
    return made;
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

// An extension on its way into a file: only what is not its default.
class GlbMaterials::Extension {
  public:
    Extension(GlbMaterials& owner, const char* name) : owner_(owner), name_(name) {}

    void number(const char* member, float value, float otherwise) {
        if (value != otherwise) members_[member] = Value(double{value});
    }
    void color(const char* member, const glm::vec3& value, float otherwise) {
        if (value == glm::vec3(otherwise)) return;
        members_[member] =
            Value(Value::Array{Value(double{value.x}), Value(double{value.y}), Value(double{value.z})});
    }
    void texture(const char* member, const scene::TextureSlot& slot, float scale = 1.0f) {
        if (auto info = owner_.info_of(slot, scale)) members_[member] = *info;
    }
    void write(tinygltf::Material& to) {
        if (members_.empty()) return;
        to.extensions[name_] = Value(std::move(members_));
        owner_.uses(name_);
    }

  private:
    GlbMaterials& owner_;
    const char* name_;
    Object members_;
};

void GlbMaterials::add_extensions(tinygltf::Material& made, const scene::Material& m) {
    if (m.unlit) {
        made.extensions["KHR_materials_unlit"] = Value(Object{});
        uses("KHR_materials_unlit");
    }
    Extension index(*this, "KHR_materials_ior");
    index.number("ior", m.index_of_refraction, 1.5f);
    index.write(made);
    Extension transmission(*this, "KHR_materials_transmission");
    transmission.number("transmissionFactor", m.transmission, 0.0f);
    transmission.texture("transmissionTexture", m.transmission_texture);
    transmission.write(made);
    Extension volume(*this, "KHR_materials_volume");
    volume.number("thicknessFactor", m.thickness, 0.0f);
    volume.number("attenuationDistance", m.attenuation_distance, 0.0f);
    volume.color("attenuationColor", m.attenuation_color, 1.0f);
    volume.write(made);
    Extension specular(*this, "KHR_materials_specular");
    specular.number("specularFactor", m.specular, 1.0f);
    specular.texture("specularTexture", m.specular_texture);
    specular.color("specularColorFactor", m.specular_color, 1.0f);
    specular.texture("specularColorTexture", m.specular_color_texture);
    specular.write(made);
    Extension coat(*this, "KHR_materials_clearcoat");
    coat.number("clearcoatFactor", m.clearcoat, 0.0f);
    coat.texture("clearcoatTexture", m.clearcoat_texture);
    coat.number("clearcoatRoughnessFactor", m.clearcoat_roughness, 0.0f);
    coat.texture("clearcoatRoughnessTexture", m.clearcoat_roughness_texture);
    coat.texture("clearcoatNormalTexture", m.clearcoat_normal_texture, m.clearcoat_normal_scale);
    coat.write(made);
    Extension sheen(*this, "KHR_materials_sheen");
    sheen.color("sheenColorFactor", m.sheen_color, 0.0f);
    sheen.texture("sheenColorTexture", m.sheen_color_texture);
    sheen.number("sheenRoughnessFactor", m.sheen_roughness, 0.0f);
    sheen.texture("sheenRoughnessTexture", m.sheen_roughness_texture);
    sheen.write(made);
    Extension anisotropy(*this, "KHR_materials_anisotropy");
    anisotropy.number("anisotropyStrength", m.anisotropy, 0.0f);
    anisotropy.number("anisotropyRotation", m.anisotropy_rotation, 0.0f);
    anisotropy.texture("anisotropyTexture", m.anisotropy_texture);
    anisotropy.write(made);
    Extension iridescence(*this, "KHR_materials_iridescence");
    iridescence.number("iridescenceFactor", m.iridescence, 0.0f);
    iridescence.texture("iridescenceTexture", m.iridescence_texture);
    iridescence.number("iridescenceIor", m.iridescence_index_of_refraction, 1.3f);
    iridescence.number("iridescenceThicknessMinimum", m.iridescence_thickness_minimum, 100.0f);
    iridescence.number("iridescenceThicknessMaximum", m.iridescence_thickness_maximum, 400.0f);
    iridescence.texture("iridescenceThicknessTexture", m.iridescence_thickness_texture);
    iridescence.write(made);
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
    if (texture->depth > 1)
        made.extras = Value(Object{{import::DepthExtras, Value(static_cast<int>(texture->depth))}});
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
        texture.width, texture.height * texture.depth, buffer_.blob(texture.texels)->as<std::uint8_t>()));
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
