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
#include "mediator/scene/field_notes.h"

// Two surface material models (Material, SurfaceShader) and one of participating media (Medium). Every value is
// factor x texture.
namespace tessera::scene {

// A texture as a material uses it: uv' = translate(offset) rotate(rotation) scale(scale) uv
// (KHR_texture_transform).
struct TextureSlot {
    ObjectId texture;
    glm::vec2 offset{0.0f}, scale{1.0f};
    float rotation = 0.0f;
    std::uint32_t set = 0;
    friend bool operator==(const TextureSlot&, const TextureSlot&) = default;
    // clang-format off
    static constexpr auto describe(auto row) {
        using T = TextureSlot;
        return std::tuple(
            row(1, "texture", &T::texture, Refers{bit(ObjectKind::Texture)}, Help{"0 = none: the factor alone"}),
            row(2, "offset", &T::offset),
            row(3, "scale", &T::scale),
            row(4, "rotation", &T::rotation, Radians),
            row(5, "set", &T::set, Range{0, 1}, Help{"which texture coordinates: tex_coords or tex_coords_1"}));
    }
    // clang-format on
};

enum class AlphaMode : std::uint8_t { Opaque, Mask, Blend };
constexpr auto enumerators(AlphaMode) {
    return std::to_array<std::string_view>({"opaque", "mask", "blend"});
}

// glTF 2.0 metallic-roughness with the KHR_materials_* extensions that affect rendering, with their names and
// meanings.
struct Material {
    static constexpr KindRow Kind{ObjectKind::Material, "material", "materials"};
    std::string name;
    glm::vec4 base_color{0.8f, 0.8f, 0.8f, 1.0f};
    TextureSlot base_color_texture;
    float metallic = 0.0f;
    float roughness = 1.0f;
    TextureSlot metallic_roughness_texture;
    TextureSlot normal_texture;
    float normal_scale = 1.0f;
    glm::vec3 emission{0.0f};
    TextureSlot emission_texture;
    AlphaMode alpha_mode = AlphaMode::Opaque;
    float alpha_cutoff = 0.5f;
    bool double_sided = false;
    bool unlit = false;
    float index_of_refraction = 1.5f;
    float transmission = 0.0f;
    TextureSlot transmission_texture;
    float thickness = 0.0f;
    glm::vec3 attenuation_color{1.0f};
    float attenuation_distance = 0.0f;
    float specular = 1.0f;
    TextureSlot specular_texture;
    glm::vec3 specular_color{1.0f};
    TextureSlot specular_color_texture;
    float clearcoat = 0.0f;
    TextureSlot clearcoat_texture;
    float clearcoat_roughness = 0.0f;
    TextureSlot clearcoat_roughness_texture;
    TextureSlot clearcoat_normal_texture;
    float clearcoat_normal_scale = 1.0f;
    glm::vec3 sheen_color{0.0f};
    TextureSlot sheen_color_texture;
    float sheen_roughness = 0.0f;
    TextureSlot sheen_roughness_texture;
    float anisotropy = 0.0f;
    float anisotropy_rotation = 0.0f;
    TextureSlot anisotropy_texture;
    float iridescence = 0.0f;
    TextureSlot iridescence_texture;
    float iridescence_index_of_refraction = 1.3f;
    float iridescence_thickness_minimum = 100.0f;
    float iridescence_thickness_maximum = 400.0f;
    TextureSlot iridescence_thickness_texture;
    bool shadow_catcher = false;
    // clang-format off
    static constexpr auto describe(auto row) {
        using T = Material;
        constexpr Unit Nanometres{"nm"};
        return std::tuple(
            row(1, "name", &T::name, MaxName),
            row(2, "base_color", &T::base_color, Fraction),
            row(3, "base_color_texture", &T::base_color_texture),
            row(4, "metallic", &T::metallic, Fraction),
            row(5, "roughness", &T::roughness, Fraction, Help{"perceptual; alpha = roughness^2"}),
            row(6, "metallic_roughness_texture", &T::metallic_roughness_texture, DataTexels{}, Help{"g = roughness, b = metallic"}),
            row(7, "normal_texture", &T::normal_texture, DataTexels{}, Help{"tangent space, rgb = (n + 1) / 2"}),
            row(8, "normal_scale", &T::normal_scale),
            row(9, "emission", &T::emission, NotNegative, Radiance),
            row(10, "emission_texture", &T::emission_texture),
            row(11, "alpha_mode", &T::alpha_mode),
            row(12, "alpha_cutoff", &T::alpha_cutoff, NotNegative),
            row(13, "double_sided", &T::double_sided),
            row(14, "unlit", &T::unlit),
            row(15, "index_of_refraction", &T::index_of_refraction, Range{0, 100}, Help{"0, or from 1"}),
            row(16, "transmission", &T::transmission, Fraction),
            row(17, "transmission_texture", &T::transmission_texture, DataTexels{}, Help{"r"}),
            row(18, "thickness", &T::thickness, NotNegative, Metres, Help{"0 = thin-walled; else a volume"}),
            row(19, "attenuation_color", &T::attenuation_color, Fraction, Help{"transmittance at attenuation_distance"}),
            row(20, "attenuation_distance", &T::attenuation_distance, NotNegative, Metres, Help{"0 = no absorption"}),
            row(21, "specular", &T::specular, Fraction),
            row(22, "specular_texture", &T::specular_texture, DataTexels{}, Help{"a"}),
            row(23, "specular_color", &T::specular_color, NotNegative),
            row(24, "specular_color_texture", &T::specular_color_texture),
            row(25, "clearcoat", &T::clearcoat, Fraction),
            row(26, "clearcoat_texture", &T::clearcoat_texture, DataTexels{}, Help{"r"}),
            row(27, "clearcoat_roughness", &T::clearcoat_roughness, Fraction),
            row(28, "clearcoat_roughness_texture", &T::clearcoat_roughness_texture, DataTexels{}, Help{"g"}),
            row(29, "clearcoat_normal_texture", &T::clearcoat_normal_texture, DataTexels{}),
            row(30, "clearcoat_normal_scale", &T::clearcoat_normal_scale),
            row(31, "sheen_color", &T::sheen_color, Fraction),
            row(32, "sheen_color_texture", &T::sheen_color_texture),
            row(33, "sheen_roughness", &T::sheen_roughness, Fraction),
            row(34, "sheen_roughness_texture", &T::sheen_roughness_texture, DataTexels{}, Help{"a"}),
            row(35, "anisotropy", &T::anisotropy, Fraction),
            row(36, "anisotropy_rotation", &T::anisotropy_rotation, Radians, Help{"from the tangent, counter-clockwise"}),
            row(37, "anisotropy_texture", &T::anisotropy_texture, DataTexels{}, Help{"rg = direction, b = strength"}),
            row(38, "iridescence", &T::iridescence, Fraction),
            row(39, "iridescence_texture", &T::iridescence_texture, DataTexels{}, Help{"r"}),
            row(40, "iridescence_index_of_refraction", &T::iridescence_index_of_refraction, Range{1, 100}),
            row(41, "iridescence_thickness_minimum", &T::iridescence_thickness_minimum, NotNegative, Nanometres),
            row(42, "iridescence_thickness_maximum", &T::iridescence_thickness_maximum, NotNegative, Nanometres),
            row(43, "iridescence_thickness_texture", &T::iridescence_thickness_texture, DataTexels{}, Help{"g"}),
            row(44, "shadow_catcher", &T::shadow_catcher, GltfExtras{}, Help{"shows only the shadows on it"}));
    }
    // clang-format on
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
    static constexpr KindRow Kind{ObjectKind::SurfaceShader, "surface_shader", "surface_shaders"};
    std::string name;
    glm::vec3 emission{0.0f};
    TextureSlot emission_texture;
    glm::vec3 ambient{0.2f};
    TextureSlot ambient_texture;
    glm::vec3 diffuse{0.8f};
    TextureSlot diffuse_texture;
    glm::vec3 specular{0.0f};
    TextureSlot specular_texture;
    glm::vec2 shininess{0.0f};
    TextureSlot shininess_texture;
    float alpha = 1.0f;
    TextureSlot alpha_texture;
    bool invert_alpha_texture = false;
    TextureSlot normal_texture;
    scene::NormalFormat normal_format = scene::NormalFormat::Unorm;
    scene::NormalSpace normal_space = scene::NormalSpace::Tangent;
    glm::vec3 normal_scale{2.0f}, normal_bias{-1.0f};
    TextureSlot height_texture;
    float height_scale = 1.0f;
    glm::vec3 reflection{0.0f};
    TextureSlot reflection_texture;
    glm::vec3 transmission{0.0f};
    TextureSlot transmission_texture;
    glm::vec3 relative_index_of_refraction{1.0f};
    float fresnel_blend = 1.0f;
    std::int32_t tangent_tex_coords = -1, binormal_tex_coords = -1;
    glm::vec3 environment{0.0f};
    TextureSlot environment_texture;
    // clang-format off
    static constexpr auto describe(auto row) {
        using T = SurfaceShader;
        constexpr Help Set{"texture coordinates whose u gives this axis; -1 = none"};
        return std::tuple(
            row(1, "name", &T::name, MaxName),
            row(2, "emission", &T::emission, NotNegative, Radiance),
            row(3, "emission_texture", &T::emission_texture),
            row(4, "ambient", &T::ambient, Fraction, Help{"not used for rendering"}),
            row(5, "ambient_texture", &T::ambient_texture),
            row(6, "diffuse", &T::diffuse, Fraction),
            row(7, "diffuse_texture", &T::diffuse_texture),
            row(8, "specular", &T::specular, Fraction, Help{"of the glossy lobe"}),
            row(9, "specular_texture", &T::specular_texture),
            row(10, "shininess", &T::shininess, Range{0, 1e6}, Help{"along tangent and binormal; Blinn's exponent = 128 x shininess"}),
            row(11, "shininess_texture", &T::shininess_texture, DataTexels{}),
            row(12, "alpha", &T::alpha, Fraction),
            row(13, "alpha_texture", &T::alpha_texture, DataTexels{}, Help{"a"}),
            row(14, "invert_alpha_texture", &T::invert_alpha_texture),
            row(15, "normal_texture", &T::normal_texture, DataTexels{}),
            row(16, "normal_format", &T::normal_format),
            row(17, "normal_space", &T::normal_space),
            row(18, "normal_scale", &T::normal_scale, Help{"normal = scale x texel + bias"}),
            row(19, "normal_bias", &T::normal_bias),
            row(20, "height_texture", &T::height_texture, DataTexels{}),
            row(21, "height_scale", &T::height_scale, Metres, Help{"displacement for a texel of 1"}),
            row(22, "reflection", &T::reflection, Fraction, Help{"of the perfect mirror"}),
            row(23, "reflection_texture", &T::reflection_texture),
            row(24, "transmission", &T::transmission, Fraction, Help{"of the smooth glass"}),
            row(25, "transmission_texture", &T::transmission_texture),
            row(26, "relative_index_of_refraction", &T::relative_index_of_refraction, Range{0.01, 100}, Help{"inside / outside, per colour channel"}),
            row(27, "fresnel_blend", &T::fresnel_blend, Fraction, Help{"weight of Fresnel's equations for both"}),
            row(28, "tangent_tex_coords", &T::tangent_tex_coords, Range{-1, 1}, Set),
            row(29, "binormal_tex_coords", &T::binormal_tex_coords, Range{-1, 1}, Set),
            row(30, "environment", &T::environment, NotNegative, Radiance, Help{"added to the background for perfect speculars"}),
            row(31, "environment_texture", &T::environment_texture));
    }
    // clang-format on
};

// X3D's CommonVolumeShader (Schwenk 5.B.3): the participating medium inside a closed geometry.
struct Medium {
    static constexpr KindRow Kind{ObjectKind::Medium, "medium", "media"};
    std::string name;
    glm::vec3 emission{0.0f};
    TextureSlot emission_texture;
    glm::vec3 absorption{0.0f};
    TextureSlot absorption_texture;
    glm::vec3 scattering{0.0f};
    TextureSlot scattering_texture;
    float anisotropy = 0.0f;
    std::int32_t priority = 0;
    // clang-format off
    static constexpr auto describe(auto row) {
        using T = Medium;
        constexpr Unit PerMetre{"1/m"};
        return std::tuple(
            row(1, "name", &T::name, MaxName),
            row(2, "emission", &T::emission, NotNegative, Unit{"W/(m3 sr)"}),
            row(3, "emission_texture", &T::emission_texture),
            row(4, "absorption", &T::absorption, NotNegative, PerMetre),
            row(5, "absorption_texture", &T::absorption_texture, DataTexels{}),
            row(6, "scattering", &T::scattering, NotNegative, PerMetre),
            row(7, "scattering_texture", &T::scattering_texture, DataTexels{}),
            row(8, "anisotropy", &T::anisotropy, Range{-1, 1}, Help{"Henyey and Greenstein's g; 0 = isotropic"}),
            row(9, "priority", &T::priority, Help{"where media overlap, the highest one wins"}));
    }
    // clang-format on
};

}  // namespace tessera::scene
