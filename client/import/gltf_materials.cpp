#include "client/import/gltf_materials.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>

namespace tessera::import {
namespace {

const tinygltf::Value* extension(const tinygltf::ExtensionMap& extensions, const char* name) {
    const auto found = extensions.find(name);
    return found == extensions.end() ? nullptr : &found->second;
}

// Brings numbers of a file into their range and remembers whether that was necessary.
class Ranges {
  public:
    float number(double value, double lowest, double highest, double otherwise) {
        const double result = std::isfinite(value) ? std::clamp(value, lowest, highest) : otherwise;
        changed_ |= result != value;
        return static_cast<float>(result);
    }
    bool changed() const { return changed_; }

  private:
    bool changed_ = false;
};

constexpr double Large = 1e6;  // of offsets and scales, beyond which texture coordinates have no digits left
constexpr double Brightest = 1e12;

// Reads the texture references of one material: slots, and which set of coordinates they all use.
class Slots {
  public:
    Slots(GltfTextures& textures, Ranges& ranges) : textures_(textures), ranges_(ranges) {}

    template <class Info>
    scene::TextureSlot slot(const Info& info, TextureUse use) {
        scene::TextureSlot slot;
        if (info.index < 0) return slot;
        slot.texture = textures_.texture(info.index, use);
        int set = info.texCoord;
        if (const tinygltf::Value* transform = extension(info.extensions, "KHR_texture_transform")) {
            const std::vector<double> offset = number_array(*transform, "offset");
            const std::vector<double> scale = number_array(*transform, "scale");
            for (int i = 0; i < 2; ++i) {
                const auto k = static_cast<std::size_t>(i);
                if (offset.size() == 2) slot.offset[i] = ranges_.number(offset[k], -Large, Large, 0.0);
                if (scale.size() == 2) slot.scale[i] = ranges_.number(scale[k], -Large, Large, 1.0);
            }
            slot.rotation = ranges_.number(number_member(*transform, "rotation", 0.0), -Large, Large, 0.0);
            if (transform->Has("texCoord")) set = index_member(*transform, "texCoord");
        }
        if (!slot.texture) return slot;
        if (set_ < 0) set_ = std::max(set, 0);
        mixed_ |= set != set_;
        return slot;
    }

    int set() const { return std::max(set_, 0); }
    bool mixed() const { return mixed_; }

  private:
    GltfTextures& textures_;
    Ranges& ranges_;
    int set_ = -1;  // of the first texture
    bool mixed_ = false;
};

}  // namespace

GltfMaterial GltfMaterials::material(int index) {
    if (index < -1 || index >= static_cast<int>(model_.materials.size())) {
        builder_.notice("material " + std::to_string(index) + " is missing: the default one is used");
        index = -1;
    }
    const auto found = made_.find(index);
    if (found != made_.end()) return found->second;
    const GltfMaterial made = index < 0 ? make(tinygltf::Material(), "default")
                                        : make(model_.materials[static_cast<std::size_t>(index)],
                                               "material " + std::to_string(index));
    made_[index] = made;
    return made;
}

GltfMaterial GltfMaterials::make(const tinygltf::Material& source, const std::string& fallback_name) {
    const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
    Ranges ranges;
    Slots slots(textures_, ranges);
    scene::Material material;
    material.name = source.name.empty() ? fallback_name : source.name;
    for (int i = 0; i < 4; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const double value = pbr.baseColorFactor.size() == 4 ? pbr.baseColorFactor[k] : 1.0;
        material.base_color[i] = ranges.number(value, 0.0, 1.0, 1.0);
    }
    material.base_color_texture = slots.slot(pbr.baseColorTexture, TextureUse::Color);
    material.metallic = ranges.number(pbr.metallicFactor, 0.0, 1.0, 1.0);
    material.roughness = ranges.number(pbr.roughnessFactor, 0.0, 1.0, 1.0);
    material.metallic_roughness_texture = slots.slot(pbr.metallicRoughnessTexture, TextureUse::Data);
    material.normal_texture = slots.slot(source.normalTexture, TextureUse::Data);
    material.normal_scale = ranges.number(source.normalTexture.scale, -1e3, 1e3, 1.0);

    double strength = 1.0;
    if (const auto* found = extension(source.extensions, "KHR_materials_emissive_strength")) {
        strength = number_member(*found, "emissiveStrength", 1.0);
    }
    for (int i = 0; i < 3; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const double factor = source.emissiveFactor.size() == 3 ? source.emissiveFactor[k] : 0.0;
        material.emission[i] = ranges.number(factor * strength, 0.0, Brightest, 0.0);
    }
    if (material.emission != glm::vec3(0.0f)) {
        material.emission_texture = slots.slot(source.emissiveTexture, TextureUse::Color);
    }
    if (source.alphaMode == "MASK") material.alpha_mode = scene::AlphaMode::Mask;
    if (source.alphaMode == "BLEND") material.alpha_mode = scene::AlphaMode::Blend;
    material.alpha_cutoff = ranges.number(source.alphaCutoff, 0.0, 1e3, 0.5);
    material.double_sided = source.doubleSided;
    material.unlit = extension(source.extensions, "KHR_materials_unlit") != nullptr;
    if (const auto* found = extension(source.extensions, "KHR_materials_ior")) {
        material.index_of_refraction = ranges.number(number_member(*found, "ior", 1.5), 1.0, 100.0, 1.5);
    }
    if (const auto* found = extension(source.extensions, "KHR_materials_transmission")) {
        material.transmission =
            ranges.number(number_member(*found, "transmissionFactor", 0.0), 0.0, 1.0, 0.0);
        if (found->Has("transmissionTexture")) {
            builder_.notice("material '" + material.name +
                            "': its transmission texture is ignored, the factor stays");
        }
    }
    if (slots.mixed()) {
        builder_.notice("material '" + material.name +
                        "': its textures use several sets of coordinates; all are drawn with set " +
                        std::to_string(slots.set()));
    }
    if (ranges.changed())
        builder_.notice("material '" + material.name + "': numbers out of range are clamped");
    GltfMaterial made;
    made.tex_coord_set = slots.set();
    made.wants_tangents = static_cast<bool>(material.normal_texture.texture);
    made.id = builder_.add(std::move(material));
    return made;
}

}  // namespace tessera::import
