#include "mediator/scene/fields.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

namespace tessera::scene {

namespace {

// Equal to the bit: a NaN equals itself, and -0 differs from 0, so that comparison agrees with the state
// hash.
template <class T>
bool same_bits(const T& a, const T& b) {
    if constexpr (std::is_floating_point_v<T>) {
        return std::memcmp(&a, &b, sizeof a) == 0;
    } else {
        return a == b;
    }
}
template <glm::length_t L, class T>
bool same_bits(const glm::vec<L, T>& a, const glm::vec<L, T>& b) {
    for (glm::length_t i = 0; i < L; ++i) {
        if (!same_bits(a[i], b[i])) return false;
    }
    return true;
}
bool same_bits(const glm::dmat4& a, const glm::dmat4& b) {
    for (glm::length_t i = 0; i < 4; ++i) {
        if (!same_bits(a[i], b[i])) return false;
    }
    return true;
}
bool same_bits(const TextureSlot& a, const TextureSlot& b) {
    return a.texture == b.texture && same_bits(a.offset, b.offset) && same_bits(a.scale, b.scale) &&
           same_bits(a.rotation, b.rotation) && a.set == b.set;
}

bool same_bits(const std::vector<glm::dmat4>& a, const std::vector<glm::dmat4>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const glm::dmat4& x, const glm::dmat4& y) { return same_bits(x, y); });
}

template <class T>
std::string_view name_in(
    unsigned field, const std::array<std::string_view, std::tuple_size_v<decltype(T::fields())>>& names) {
    return field < names.size() ? names[field] : std::string_view();
}

}  // namespace

FieldMask all_fields(const Object& object) {
    return std::visit([]<class T>(const T&) { return Fields<T>::all().bits(); }, object);
}

void assign(Object& to, const Object& from, FieldMask mask) {
    assert(to.index() == from.index());
    std::visit(
        [&]<class T>(T& target) {
            const T& source = std::get<T>(from);
            for_each_field<T>([&](unsigned bit, auto member) {
                if ((mask >> bit) & 1u) target.*member = source.*member;
            });
        },
        to);
}

FieldMask differing_fields(const Object& a, const Object& b) {
    assert(a.index() == b.index());
    FieldMask mask = 0;
    std::visit(
        [&]<class T>(const T& left) {
            const T& right = std::get<T>(b);
            for_each_field<T>([&](unsigned bit, auto member) {
                if (!same_bits(left.*member, right.*member)) mask |= field_bit(bit);
            });
        },
        a);
    return mask;
}

std::string_view field_name(ObjectKind kind, unsigned field) {
    switch (kind) {
        case ObjectKind::Root:
            return name_in<Root>(field, {"name", "children", "background", "render_origin"});
        case ObjectKind::Transform:
            return name_in<Transform>(field, {"name", "matrix", "children", "hint", "layers", "motion"});
        case ObjectKind::Geometry:
            return name_in<Geometry>(field, {"name", "material", "hint", "indices", "positions", "normals",
                                             "tangents", "tex_coords", "colors", "tex_coords_1", "medium",
                                             "motion_positions", "motion_normals"});
        case ObjectKind::Material:
            return name_in<Material>(field, {"name",
                                             "base_color",
                                             "base_color_texture",
                                             "metallic",
                                             "roughness",
                                             "metallic_roughness_texture",
                                             "normal_texture",
                                             "normal_scale",
                                             "emission",
                                             "emission_texture",
                                             "alpha_mode",
                                             "alpha_cutoff",
                                             "double_sided",
                                             "unlit",
                                             "index_of_refraction",
                                             "transmission",
                                             "transmission_texture",
                                             "thickness",
                                             "attenuation_color",
                                             "attenuation_distance",
                                             "specular",
                                             "specular_texture",
                                             "specular_color",
                                             "specular_color_texture",
                                             "clearcoat",
                                             "clearcoat_texture",
                                             "clearcoat_roughness",
                                             "clearcoat_roughness_texture",
                                             "clearcoat_normal_texture",
                                             "clearcoat_normal_scale",
                                             "sheen_color",
                                             "sheen_color_texture",
                                             "sheen_roughness",
                                             "sheen_roughness_texture",
                                             "anisotropy",
                                             "anisotropy_rotation",
                                             "anisotropy_texture",
                                             "iridescence",
                                             "iridescence_texture",
                                             "iridescence_index_of_refraction",
                                             "iridescence_thickness_minimum",
                                             "iridescence_thickness_maximum",
                                             "iridescence_thickness_texture",
                                             "shadow_catcher"});
        case ObjectKind::Texture:
            return name_in<Texture>(field, {"name", "width", "height", "format", "wrap_s", "wrap_t", "filter",
                                            "texels", "depth"});
        case ObjectKind::Light:
            return name_in<Light>(field, {"name", "kind", "intensity", "inner_cone_angle", "outer_cone_angle",
                                          "radius", "size", "angle"});
        case ObjectKind::Camera:
            return name_in<Camera>(
                field, {"name", "vertical_fov", "aspect_ratio", "projection", "orthographic_height",
                        "lens_radius", "focus_distance", "aperture"});
        case ObjectKind::Background:
            return name_in<Background>(
                field, {"name", "color", "environment", "strength", "rotation", "visible", "visible_color"});
        case ObjectKind::Attachment:
            return name_in<Attachment>(field, {"name", "key", "value"});
        case ObjectKind::SurfaceShader:
            return name_in<SurfaceShader>(field, {"name",
                                                  "emission",
                                                  "emission_texture",
                                                  "ambient",
                                                  "ambient_texture",
                                                  "diffuse",
                                                  "diffuse_texture",
                                                  "specular",
                                                  "specular_texture",
                                                  "shininess",
                                                  "shininess_texture",
                                                  "alpha",
                                                  "alpha_texture",
                                                  "invert_alpha_texture",
                                                  "normal_texture",
                                                  "normal_format",
                                                  "normal_space",
                                                  "normal_scale",
                                                  "normal_bias",
                                                  "height_texture",
                                                  "height_scale",
                                                  "reflection",
                                                  "reflection_texture",
                                                  "transmission",
                                                  "transmission_texture",
                                                  "relative_index_of_refraction",
                                                  "fresnel_blend",
                                                  "tangent_tex_coords",
                                                  "binormal_tex_coords",
                                                  "environment",
                                                  "environment_texture"});
        case ObjectKind::Medium:
            return name_in<Medium>(
                field, {"name", "emission", "emission_texture", "absorption", "absorption_texture",
                        "scattering", "scattering_texture", "anisotropy", "priority"});
    }
    return {};
}

}  // namespace tessera::scene
