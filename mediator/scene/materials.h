#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <string>
#include <string_view>
#include <tuple>

#include "mediator/base/ids.h"

// What surfaces and media are made of: two models of surfaces (Material, SurfaceShader) and one of what fills
// a body (Medium). Every value is factor x texture.
namespace tessera::scene {

// A texture as a material uses it: uv' = translate(offset) rotate(rotation) scale(scale) uv
// (KHR_texture_transform).
struct TextureSlot {
    ObjectId texture;  // 0 = none: the factor alone
    glm::vec2 offset{0.0f}, scale{1.0f};
    float rotation = 0.0f;
    std::uint32_t set = 0;  // which texture coordinates of a geometry: tex_coords or tex_coords_1
    friend bool operator==(const TextureSlot&, const TextureSlot&) = default;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "texture", &TextureSlot::texture), row(2, "offset", &TextureSlot::offset),
                          row(3, "scale", &TextureSlot::scale), row(4, "rotation", &TextureSlot::rotation),
                          row(5, "set", &TextureSlot::set));
    }
};

enum class AlphaMode : std::uint8_t { Opaque, Mask, Blend };
constexpr auto enumerators(AlphaMode) {
    return std::to_array<std::string_view>({"opaque", "mask", "blend"});
}

// glTF 2.0 metallic-roughness with the KHR_materials_* extensions that light can tell; names and meanings are
// theirs.
struct Material {
    enum class Field : std::uint8_t {
        Name,
        BaseColor,
        BaseColorTexture,
        Metallic,
        Roughness,
        MetallicRoughnessTexture,
        NormalTexture,
        NormalScale,
        Emission,
        EmissionTexture,
        AlphaMode,
        AlphaCutoff,
        DoubleSided,
        Unlit,
        IndexOfRefraction,
        Transmission,
        TransmissionTexture,
        Thickness,
        AttenuationColor,
        AttenuationDistance,
        Specular,
        SpecularTexture,
        SpecularColor,
        SpecularColorTexture,
        Clearcoat,
        ClearcoatTexture,
        ClearcoatRoughness,
        ClearcoatRoughnessTexture,
        ClearcoatNormalTexture,
        ClearcoatNormalScale,
        SheenColor,
        SheenColorTexture,
        SheenRoughness,
        SheenRoughnessTexture,
        Anisotropy,
        AnisotropyRotation,
        AnisotropyTexture,
        Iridescence,
        IridescenceTexture,
        IridescenceIndexOfRefraction,
        IridescenceThicknessMinimum,
        IridescenceThicknessMaximum,
        IridescenceThicknessTexture,
        ShadowCatcher
    };
    std::string name;
    glm::vec4 base_color{0.8f, 0.8f, 0.8f, 1.0f};
    TextureSlot base_color_texture;  // sRGB
    float metallic = 0.0f;
    float roughness = 1.0f;                  // perceptual; alpha = roughness^2
    TextureSlot metallic_roughness_texture;  // g = roughness, b = metallic
    TextureSlot normal_texture;              // tangent space, rgb = (n + 1) / 2
    float normal_scale = 1.0f;
    glm::vec3 emission{0.0f};      // radiance, strength included
    TextureSlot emission_texture;  // sRGB
    AlphaMode alpha_mode = AlphaMode::Opaque;
    float alpha_cutoff = 0.5f;
    bool double_sided = false;
    bool unlit = false;
    float index_of_refraction = 1.5f;
    float transmission = 0.0f;
    TextureSlot transmission_texture;   // r
    float thickness = 0.0f;             // 0: thin walls; else a solid body
    glm::vec3 attenuation_color{1.0f};  // what is left of white light
    float attenuation_distance = 0.0f;  // after so many metres of the body; 0: all of it, always
    float specular = 1.0f;
    TextureSlot specular_texture;  // a
    glm::vec3 specular_color{1.0f};
    TextureSlot specular_color_texture;  // sRGB
    float clearcoat = 0.0f;
    TextureSlot clearcoat_texture;  // r
    float clearcoat_roughness = 0.0f;
    TextureSlot clearcoat_roughness_texture;  // g
    TextureSlot clearcoat_normal_texture;
    float clearcoat_normal_scale = 1.0f;
    glm::vec3 sheen_color{0.0f};
    TextureSlot sheen_color_texture;  // sRGB
    float sheen_roughness = 0.0f;
    TextureSlot sheen_roughness_texture;  // a
    float anisotropy = 0.0f;              // strength
    float anisotropy_rotation = 0.0f;     // from the tangent, counter-clockwise
    TextureSlot anisotropy_texture;       // rg = direction, b = strength
    float iridescence = 0.0f;
    TextureSlot iridescence_texture;  // r
    float iridescence_index_of_refraction = 1.3f;
    float iridescence_thickness_minimum = 100.0f, iridescence_thickness_maximum = 400.0f;  // nm
    TextureSlot iridescence_thickness_texture;                                             // g
    bool shadow_catcher = false;  // shows nothing but the shadows on it (Lardinoije 3)
    static constexpr auto fields() {
        return std::tuple(
            &Material::name, &Material::base_color, &Material::base_color_texture, &Material::metallic,
            &Material::roughness, &Material::metallic_roughness_texture, &Material::normal_texture,
            &Material::normal_scale, &Material::emission, &Material::emission_texture, &Material::alpha_mode,
            &Material::alpha_cutoff, &Material::double_sided, &Material::unlit,
            &Material::index_of_refraction, &Material::transmission, &Material::transmission_texture,
            &Material::thickness, &Material::attenuation_color, &Material::attenuation_distance,
            &Material::specular, &Material::specular_texture, &Material::specular_color,
            &Material::specular_color_texture, &Material::clearcoat, &Material::clearcoat_texture,
            &Material::clearcoat_roughness, &Material::clearcoat_roughness_texture,
            &Material::clearcoat_normal_texture, &Material::clearcoat_normal_scale, &Material::sheen_color,
            &Material::sheen_color_texture, &Material::sheen_roughness, &Material::sheen_roughness_texture,
            &Material::anisotropy, &Material::anisotropy_rotation, &Material::anisotropy_texture,
            &Material::iridescence, &Material::iridescence_texture,
            &Material::iridescence_index_of_refraction, &Material::iridescence_thickness_minimum,
            &Material::iridescence_thickness_maximum, &Material::iridescence_thickness_texture,
            &Material::shadow_catcher);
    }
    static constexpr auto describe(auto row) {
        return std::tuple(
            row(1, "name", &Material::name), row(2, "base_color", &Material::base_color),
            row(3, "base_color_texture", &Material::base_color_texture),
            row(4, "metallic", &Material::metallic), row(5, "roughness", &Material::roughness),
            row(6, "metallic_roughness_texture", &Material::metallic_roughness_texture),
            row(7, "normal_texture", &Material::normal_texture),
            row(8, "normal_scale", &Material::normal_scale), row(9, "emission", &Material::emission),
            row(10, "emission_texture", &Material::emission_texture),
            row(11, "alpha_mode", &Material::alpha_mode), row(12, "alpha_cutoff", &Material::alpha_cutoff),
            row(13, "double_sided", &Material::double_sided), row(14, "unlit", &Material::unlit),
            row(15, "index_of_refraction", &Material::index_of_refraction),
            row(16, "transmission", &Material::transmission),
            row(17, "transmission_texture", &Material::transmission_texture),
            row(18, "thickness", &Material::thickness),
            row(19, "attenuation_color", &Material::attenuation_color),
            row(20, "attenuation_distance", &Material::attenuation_distance),
            row(21, "specular", &Material::specular),
            row(22, "specular_texture", &Material::specular_texture),
            row(23, "specular_color", &Material::specular_color),
            row(24, "specular_color_texture", &Material::specular_color_texture),
            row(25, "clearcoat", &Material::clearcoat),
            row(26, "clearcoat_texture", &Material::clearcoat_texture),
            row(27, "clearcoat_roughness", &Material::clearcoat_roughness),
            row(28, "clearcoat_roughness_texture", &Material::clearcoat_roughness_texture),
            row(29, "clearcoat_normal_texture", &Material::clearcoat_normal_texture),
            row(30, "clearcoat_normal_scale", &Material::clearcoat_normal_scale),
            row(31, "sheen_color", &Material::sheen_color),
            row(32, "sheen_color_texture", &Material::sheen_color_texture),
            row(33, "sheen_roughness", &Material::sheen_roughness),
            row(34, "sheen_roughness_texture", &Material::sheen_roughness_texture),
            row(35, "anisotropy", &Material::anisotropy),
            row(36, "anisotropy_rotation", &Material::anisotropy_rotation),
            row(37, "anisotropy_texture", &Material::anisotropy_texture),
            row(38, "iridescence", &Material::iridescence),
            row(39, "iridescence_texture", &Material::iridescence_texture),
            row(40, "iridescence_index_of_refraction", &Material::iridescence_index_of_refraction),
            row(41, "iridescence_thickness_minimum", &Material::iridescence_thickness_minimum),
            row(42, "iridescence_thickness_maximum", &Material::iridescence_thickness_maximum),
            row(43, "iridescence_thickness_texture", &Material::iridescence_thickness_texture),
            row(44, "shadow_catcher", &Material::shadow_catcher));
    }
};

// How a normal map's texels are stored (unsigned normalised: 0 .. 1) and what they are relative to.
enum class NormalFormat : std::uint8_t { Unorm, Snorm };
constexpr auto enumerators(NormalFormat) {
    return std::to_array<std::string_view>({"unorm", "snorm"});
}
enum class NormalSpace : std::uint8_t { Tangent, Object };
constexpr auto enumerators(NormalSpace) {
    return std::to_array<std::string_view>({"tangent", "object"});
}

// X3D's CommonSurfaceShader (Schwenk 5.A.3), with the defaults of the thesis.
struct SurfaceShader {
    enum class Field : std::uint8_t {
        Name,
        Emission,
        EmissionTexture,
        Ambient,
        AmbientTexture,
        Diffuse,
        DiffuseTexture,
        Specular,
        SpecularTexture,
        Shininess,
        ShininessTexture,
        Alpha,
        AlphaTexture,
        InvertAlphaTexture,
        NormalTexture,
        NormalFormat,
        NormalSpace,
        NormalScale,
        NormalBias,
        HeightTexture,
        HeightScale,
        Reflection,
        ReflectionTexture,
        Transmission,
        TransmissionTexture,
        RelativeIndexOfRefraction,
        FresnelBlend,
        TangentTexCoords,
        BinormalTexCoords,
        Environment,
        EnvironmentTexture
    };
    std::string name;
    glm::vec3 emission{0.0f};  // radiance
    TextureSlot emission_texture;
    glm::vec3 ambient{0.2f};  // no path tracer's business
    TextureSlot ambient_texture;
    glm::vec3 diffuse{0.8f};
    TextureSlot diffuse_texture;
    glm::vec3 specular{0.0f};  // of the glossy lobe
    TextureSlot specular_texture;
    glm::vec2 shininess{0.0f};  // along tangent and binormal; Blinn's exponent = 128 x shininess
    TextureSlot shininess_texture;
    float alpha = 1.0f;
    TextureSlot alpha_texture;  // a
    bool invert_alpha_texture = false;
    TextureSlot normal_texture;
    scene::NormalFormat normal_format = scene::NormalFormat::Unorm;
    scene::NormalSpace normal_space = scene::NormalSpace::Tangent;
    glm::vec3 normal_scale{2.0f}, normal_bias{-1.0f};  // normal = scale x texel + bias
    TextureSlot height_texture;
    float height_scale = 1.0f;   // metres that a texel of 1 stands out
    glm::vec3 reflection{0.0f};  // of the perfect mirror
    TextureSlot reflection_texture;
    glm::vec3 transmission{0.0f};  // of the smooth glass
    TextureSlot transmission_texture;
    glm::vec3 relative_index_of_refraction{1.0f};  // inside / outside, for each channel
    float fresnel_blend = 1.0f;                    // how far Fresnel's equations weigh the two
    std::int32_t tangent_tex_coords = -1, binormal_tex_coords = -1;  // sets whose u are the frame; -1: none
    glm::vec3 environment{0.0f};  // what perfect speculars see where nothing is hit, besides the sky
    TextureSlot environment_texture;
    static constexpr auto fields() {
        return std::tuple(
            &SurfaceShader::name, &SurfaceShader::emission, &SurfaceShader::emission_texture,
            &SurfaceShader::ambient, &SurfaceShader::ambient_texture, &SurfaceShader::diffuse,
            &SurfaceShader::diffuse_texture, &SurfaceShader::specular, &SurfaceShader::specular_texture,
            &SurfaceShader::shininess, &SurfaceShader::shininess_texture, &SurfaceShader::alpha,
            &SurfaceShader::alpha_texture, &SurfaceShader::invert_alpha_texture,
            &SurfaceShader::normal_texture, &SurfaceShader::normal_format, &SurfaceShader::normal_space,
            &SurfaceShader::normal_scale, &SurfaceShader::normal_bias, &SurfaceShader::height_texture,
            &SurfaceShader::height_scale, &SurfaceShader::reflection, &SurfaceShader::reflection_texture,
            &SurfaceShader::transmission, &SurfaceShader::transmission_texture,
            &SurfaceShader::relative_index_of_refraction, &SurfaceShader::fresnel_blend,
            &SurfaceShader::tangent_tex_coords, &SurfaceShader::binormal_tex_coords,
            &SurfaceShader::environment, &SurfaceShader::environment_texture);
    }
    static constexpr auto describe(auto row) {
        return std::tuple(
            row(1, "name", &SurfaceShader::name), row(2, "emission", &SurfaceShader::emission),
            row(3, "emission_texture", &SurfaceShader::emission_texture),
            row(4, "ambient", &SurfaceShader::ambient),
            row(5, "ambient_texture", &SurfaceShader::ambient_texture),
            row(6, "diffuse", &SurfaceShader::diffuse),
            row(7, "diffuse_texture", &SurfaceShader::diffuse_texture),
            row(8, "specular", &SurfaceShader::specular),
            row(9, "specular_texture", &SurfaceShader::specular_texture),
            row(10, "shininess", &SurfaceShader::shininess),
            row(11, "shininess_texture", &SurfaceShader::shininess_texture),
            row(12, "alpha", &SurfaceShader::alpha), row(13, "alpha_texture", &SurfaceShader::alpha_texture),
            row(14, "invert_alpha_texture", &SurfaceShader::invert_alpha_texture),
            row(15, "normal_texture", &SurfaceShader::normal_texture),
            row(16, "normal_format", &SurfaceShader::normal_format),
            row(17, "normal_space", &SurfaceShader::normal_space),
            row(18, "normal_scale", &SurfaceShader::normal_scale),
            row(19, "normal_bias", &SurfaceShader::normal_bias),
            row(20, "height_texture", &SurfaceShader::height_texture),
            row(21, "height_scale", &SurfaceShader::height_scale),
            row(22, "reflection", &SurfaceShader::reflection),
            row(23, "reflection_texture", &SurfaceShader::reflection_texture),
            row(24, "transmission", &SurfaceShader::transmission),
            row(25, "transmission_texture", &SurfaceShader::transmission_texture),
            row(26, "relative_index_of_refraction", &SurfaceShader::relative_index_of_refraction),
            row(27, "fresnel_blend", &SurfaceShader::fresnel_blend),
            row(28, "tangent_tex_coords", &SurfaceShader::tangent_tex_coords),
            row(29, "binormal_tex_coords", &SurfaceShader::binormal_tex_coords),
            row(30, "environment", &SurfaceShader::environment),
            row(31, "environment_texture", &SurfaceShader::environment_texture));
    }
};

// X3D's CommonVolumeShader (Schwenk 5.B.3): what the body of a closed geometry is filled with, per metre.
struct Medium {
    enum class Field : std::uint8_t {
        Name,
        Emission,
        EmissionTexture,
        Absorption,
        AbsorptionTexture,
        Scattering,
        ScatteringTexture,
        Anisotropy,
        Priority
    };
    std::string name;
    glm::vec3 emission{0.0f};  // radiance per metre
    TextureSlot emission_texture;
    glm::vec3 absorption{0.0f};
    TextureSlot absorption_texture;
    glm::vec3 scattering{0.0f};
    TextureSlot scattering_texture;
    float anisotropy = 0.0f;    // Henyey and Greenstein's g; 0 = isotropic
    std::int32_t priority = 0;  // where bodies overlap, the highest fills them
    static constexpr auto fields() {
        return std::tuple(&Medium::name, &Medium::emission, &Medium::emission_texture, &Medium::absorption,
                          &Medium::absorption_texture, &Medium::scattering, &Medium::scattering_texture,
                          &Medium::anisotropy, &Medium::priority);
    }
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "name", &Medium::name), row(2, "emission", &Medium::emission),
                          row(3, "emission_texture", &Medium::emission_texture),
                          row(4, "absorption", &Medium::absorption),
                          row(5, "absorption_texture", &Medium::absorption_texture),
                          row(6, "scattering", &Medium::scattering),
                          row(7, "scattering_texture", &Medium::scattering_texture),
                          row(8, "anisotropy", &Medium::anisotropy), row(9, "priority", &Medium::priority));
    }
};

}  // namespace tessera::scene
