#include "client/import/gltf_extensions.h"

#include "mediator/scene/fields.h"

namespace tessera::import {

namespace {

using scene::Material;

constexpr double Large = 1e12, Turns = 1e6;

constexpr const char *Ior = "KHR_materials_ior", *Transmission = "KHR_materials_transmission",
                     *Volume = "KHR_materials_volume", *Specular = "KHR_materials_specular",
                     *Coat = "KHR_materials_clearcoat", *Sheen = "KHR_materials_sheen",
                     *Anisotropy = "KHR_materials_anisotropy", *Iridescence = "KHR_materials_iridescence";

// clang-format off
constexpr GltfMember Members[] = {
    {Ior, "ior", &Material::index_of_refraction, 1.0, 100.0},
    {Transmission, "transmissionFactor", &Material::transmission},
    {Transmission, "transmissionTexture", &Material::transmission_texture},
    {Volume, "thicknessFactor", &Material::thickness, 0.0, Large},
    {Volume, "attenuationDistance", &Material::attenuation_distance, 1.0 / Large, Large},
    {Volume, "attenuationColor", &Material::attenuation_color},
    {Specular, "specularFactor", &Material::specular},
    {Specular, "specularTexture", &Material::specular_texture},
    {Specular, "specularColorFactor", &Material::specular_color, 0.0, Large},
    {Specular, "specularColorTexture", &Material::specular_color_texture},
    {Coat, "clearcoatFactor", &Material::clearcoat},
    {Coat, "clearcoatTexture", &Material::clearcoat_texture},
    {Coat, "clearcoatRoughnessFactor", &Material::clearcoat_roughness},
    {Coat, "clearcoatRoughnessTexture", &Material::clearcoat_roughness_texture},
    {Coat, "clearcoatNormalTexture", &Material::clearcoat_normal_texture},
    {Sheen, "sheenColorFactor", &Material::sheen_color},
    {Sheen, "sheenColorTexture", &Material::sheen_color_texture},
    {Sheen, "sheenRoughnessFactor", &Material::sheen_roughness},
    {Sheen, "sheenRoughnessTexture", &Material::sheen_roughness_texture},
    {Anisotropy, "anisotropyStrength", &Material::anisotropy},
    {Anisotropy, "anisotropyRotation", &Material::anisotropy_rotation, -Turns, Turns},
    {Anisotropy, "anisotropyTexture", &Material::anisotropy_texture},
    {Iridescence, "iridescenceFactor", &Material::iridescence},
    {Iridescence, "iridescenceTexture", &Material::iridescence_texture},
    {Iridescence, "iridescenceIor", &Material::iridescence_index_of_refraction, 1.0, 100.0},
    {Iridescence, "iridescenceThicknessMinimum", &Material::iridescence_thickness_minimum, 0.0, Large},
    {Iridescence, "iridescenceThicknessMaximum", &Material::iridescence_thickness_maximum, 0.0, Large},
    {Iridescence, "iridescenceThicknessTexture", &Material::iridescence_thickness_texture},
};
// clang-format on

}  // namespace

std::span<const GltfMember> gltf_members() {
    return Members;
}

TextureUse use_of(scene::TextureSlot Material::*field) {
    TextureUse use = TextureUse::Color;
    for_each_row<Material>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
        constexpr auto& row = row_of<Material, I>;
        if constexpr (std::decay_t<decltype(row)>::template has<scene::DataTexels>) {
            if (row.access == field) use = TextureUse::Data;
        }
    });
    return use;
}

}  // namespace tessera::import
