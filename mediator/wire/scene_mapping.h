#pragma once

#include "mediator/scene/objects.h"
#include "mediator/wire/common_mapping.h"
#include "proto/scene.pb.h"

// Private to wire/*.cpp: scene objects. An update carries the fields of its mask only.
namespace tessera::wire {

template <>
constexpr scene::MotionHint last_of() {
    return scene::MotionHint::Animated;
}
template <>
constexpr scene::AlphaMode last_of() {
    return scene::AlphaMode::Blend;
}
template <>
constexpr scene::TexelFormat last_of() {
    return scene::TexelFormat::RgbFloat;
}
template <>
constexpr scene::Wrap last_of() {
    return scene::Wrap::Clamp;
}
template <>
constexpr scene::TextureFilter last_of() {
    return scene::TextureFilter::Nearest;
}
template <>
constexpr scene::LightKind last_of() {
    return scene::LightKind::Quad;
}
template <>
constexpr scene::VisibleBackground last_of() {
    return scene::VisibleBackground::Color;
}
template <>
constexpr scene::NormalFormat last_of() {
    return scene::NormalFormat::Snorm;
}
template <>
constexpr scene::NormalSpace last_of() {
    return scene::NormalSpace::Object;
}

inline constexpr std::size_t MaxChildren = 16'000'000;

template <class Io>
void map(const Io& io, typename Io::template Ref<scene::TextureSlot> s, proto::TextureSlot& p) {
    using P = proto::TextureSlot;
    io(s.texture, p, &P::texture, &P::set_texture);
    io.vector(s.offset, p.mutable_offset());
    io.vector(s.scale, p.mutable_scale());
    io(s.rotation, p, &P::rotation, &P::set_rotation);
    io(s.set, p, &P::set, &P::set_set);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<scene::Root> s, proto::Root& p) {
    using enum scene::Root::Field;
    using P = proto::Root;
    if (io.has(Name)) io.text(s.name, p.mutable_name());
    if (io.has(Children)) io.list(s.children, p.mutable_children(), MaxChildren);
    if (io.has(Background)) io(s.background, p, &P::background, &P::set_background);
    if (io.has(RenderOrigin)) io.vector(s.render_origin, p.mutable_render_origin());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<scene::Transform> s, proto::Transform& p) {
    using enum scene::Transform::Field;
    using P = proto::Transform;
    if (io.has(Name)) io.text(s.name, p.mutable_name());
    if (io.has(Matrix)) io.matrix(s.matrix, p.mutable_matrix());
    if (io.has(Children)) io.list(s.children, p.mutable_children(), MaxChildren);
    if (io.has(Hint)) io(s.hint, p, &P::hint, &P::set_hint);
    if (io.has(Layers)) io(s.layers, p, &P::layers, &P::set_layers);
    if (io.has(Motion)) io.matrices(s.motion, p.mutable_motion(), MaxSteps);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<scene::Geometry> s, proto::Geometry& p) {
    using enum scene::Geometry::Field;
    using P = proto::Geometry;
    if (io.has(Name)) io.text(s.name, p.mutable_name());
    if (io.has(Material)) io(s.material, p, &P::material, &P::set_material);
    if (io.has(Hint)) io(s.hint, p, &P::hint, &P::set_hint);
    if (io.has(Indices)) io.message(s.indices, p.mutable_indices());
    if (io.has(Positions)) io.message(s.positions, p.mutable_positions());
    if (io.has(Normals)) io.message(s.normals, p.mutable_normals());
    if (io.has(Tangents)) io.message(s.tangents, p.mutable_tangents());
    if (io.has(TexCoords)) io.message(s.tex_coords, p.mutable_tex_coords());
    if (io.has(Colors)) io.message(s.colors, p.mutable_colors());
    if (io.has(TexCoords1)) io.message(s.tex_coords_1, p.mutable_tex_coords_1());
    if (io.has(Medium)) io(s.medium, p, &P::medium, &P::set_medium);
    if (io.has(MotionPositions)) io.messages(s.motion_positions, p.mutable_motion_positions(), MaxSteps);
    if (io.has(MotionNormals)) io.messages(s.motion_normals, p.mutable_motion_normals(), MaxSteps);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<scene::Material> s, proto::Material& p) {
    using enum scene::Material::Field;
    using P = proto::Material;
    if (io.has(Name)) io.text(s.name, p.mutable_name());
    if (io.has(BaseColor)) io.vector(s.base_color, p.mutable_base_color());
    if (io.has(BaseColorTexture)) io.message(s.base_color_texture, p.mutable_base_color_texture());
    if (io.has(Metallic)) io(s.metallic, p, &P::metallic, &P::set_metallic);
    if (io.has(Roughness)) io(s.roughness, p, &P::roughness, &P::set_roughness);
    if (io.has(MetallicRoughnessTexture))
        io.message(s.metallic_roughness_texture, p.mutable_metallic_roughness_texture());
    if (io.has(NormalTexture)) io.message(s.normal_texture, p.mutable_normal_texture());
    if (io.has(NormalScale)) io(s.normal_scale, p, &P::normal_scale, &P::set_normal_scale);
    if (io.has(Emission)) io.vector(s.emission, p.mutable_emission());
    if (io.has(EmissionTexture)) io.message(s.emission_texture, p.mutable_emission_texture());
    if (io.has(AlphaMode)) io(s.alpha_mode, p, &P::alpha_mode, &P::set_alpha_mode);
    if (io.has(AlphaCutoff)) io(s.alpha_cutoff, p, &P::alpha_cutoff, &P::set_alpha_cutoff);
    if (io.has(DoubleSided)) io(s.double_sided, p, &P::double_sided, &P::set_double_sided);
    if (io.has(Unlit)) io(s.unlit, p, &P::unlit, &P::set_unlit);
    if (io.has(IndexOfRefraction))
        io(s.index_of_refraction, p, &P::index_of_refraction, &P::set_index_of_refraction);
    if (io.has(Transmission)) io(s.transmission, p, &P::transmission, &P::set_transmission);
    if (io.has(TransmissionTexture)) io.message(s.transmission_texture, p.mutable_transmission_texture());
    if (io.has(Thickness)) io(s.thickness, p, &P::thickness, &P::set_thickness);
    if (io.has(AttenuationColor)) io.vector(s.attenuation_color, p.mutable_attenuation_color());
    if (io.has(AttenuationDistance))
        io(s.attenuation_distance, p, &P::attenuation_distance, &P::set_attenuation_distance);
    if (io.has(Specular)) io(s.specular, p, &P::specular, &P::set_specular);
    if (io.has(SpecularTexture)) io.message(s.specular_texture, p.mutable_specular_texture());
    if (io.has(SpecularColor)) io.vector(s.specular_color, p.mutable_specular_color());
    if (io.has(SpecularColorTexture))
        io.message(s.specular_color_texture, p.mutable_specular_color_texture());
    if (io.has(Clearcoat)) io(s.clearcoat, p, &P::clearcoat, &P::set_clearcoat);
    if (io.has(ClearcoatTexture)) io.message(s.clearcoat_texture, p.mutable_clearcoat_texture());
    if (io.has(ClearcoatRoughness))
        io(s.clearcoat_roughness, p, &P::clearcoat_roughness, &P::set_clearcoat_roughness);
    if (io.has(ClearcoatRoughnessTexture))
        io.message(s.clearcoat_roughness_texture, p.mutable_clearcoat_roughness_texture());
    if (io.has(ClearcoatNormalTexture))
        io.message(s.clearcoat_normal_texture, p.mutable_clearcoat_normal_texture());
    if (io.has(ClearcoatNormalScale))
        io(s.clearcoat_normal_scale, p, &P::clearcoat_normal_scale, &P::set_clearcoat_normal_scale);
    if (io.has(SheenColor)) io.vector(s.sheen_color, p.mutable_sheen_color());
    if (io.has(SheenColorTexture)) io.message(s.sheen_color_texture, p.mutable_sheen_color_texture());
    if (io.has(SheenRoughness)) io(s.sheen_roughness, p, &P::sheen_roughness, &P::set_sheen_roughness);
    if (io.has(SheenRoughnessTexture))
        io.message(s.sheen_roughness_texture, p.mutable_sheen_roughness_texture());
    if (io.has(Anisotropy)) io(s.anisotropy, p, &P::anisotropy, &P::set_anisotropy);
    if (io.has(AnisotropyRotation))
        io(s.anisotropy_rotation, p, &P::anisotropy_rotation, &P::set_anisotropy_rotation);
    if (io.has(AnisotropyTexture)) io.message(s.anisotropy_texture, p.mutable_anisotropy_texture());
    if (io.has(Iridescence)) io(s.iridescence, p, &P::iridescence, &P::set_iridescence);
    if (io.has(IridescenceTexture)) io.message(s.iridescence_texture, p.mutable_iridescence_texture());
    if (io.has(IridescenceIndexOfRefraction))
        io(s.iridescence_index_of_refraction, p, &P::iridescence_index_of_refraction,
           &P::set_iridescence_index_of_refraction);
    if (io.has(IridescenceThicknessMinimum))
        io(s.iridescence_thickness_minimum, p, &P::iridescence_thickness_minimum,
           &P::set_iridescence_thickness_minimum);
    if (io.has(IridescenceThicknessMaximum))
        io(s.iridescence_thickness_maximum, p, &P::iridescence_thickness_maximum,
           &P::set_iridescence_thickness_maximum);
    if (io.has(IridescenceThicknessTexture))
        io.message(s.iridescence_thickness_texture, p.mutable_iridescence_thickness_texture());
    if (io.has(ShadowCatcher)) io(s.shadow_catcher, p, &P::shadow_catcher, &P::set_shadow_catcher);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<scene::Texture> s, proto::Texture& p) {
    using enum scene::Texture::Field;
    using P = proto::Texture;
    if (io.has(Name)) io.text(s.name, p.mutable_name());
    if (io.has(Width)) io(s.width, p, &P::width, &P::set_width);
    if (io.has(Height)) io(s.height, p, &P::height, &P::set_height);
    if (io.has(Format)) io(s.format, p, &P::format, &P::set_format);
    if (io.has(WrapS)) io(s.wrap_s, p, &P::wrap_s, &P::set_wrap_s);
    if (io.has(WrapT)) io(s.wrap_t, p, &P::wrap_t, &P::set_wrap_t);
    if (io.has(Filter)) io(s.filter, p, &P::filter, &P::set_filter);
    if (io.has(Texels)) io.message(s.texels, p.mutable_texels());
    if (io.has(Depth)) io(s.depth, p, &P::depth, &P::set_depth);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<scene::Light> s, proto::Light& p) {
    using enum scene::Light::Field;
    using P = proto::Light;
    if (io.has(Name)) io.text(s.name, p.mutable_name());
    if (io.has(Kind)) io(s.kind, p, &P::kind, &P::set_kind);
    if (io.has(Intensity)) io.vector(s.intensity, p.mutable_intensity());
    if (io.has(InnerConeAngle)) io(s.inner_cone_angle, p, &P::inner_cone_angle, &P::set_inner_cone_angle);
    if (io.has(OuterConeAngle)) io(s.outer_cone_angle, p, &P::outer_cone_angle, &P::set_outer_cone_angle);
    if (io.has(Radius)) io(s.radius, p, &P::radius, &P::set_radius);
    if (io.has(Size)) io.vector(s.size, p.mutable_size());
    if (io.has(Angle)) io(s.angle, p, &P::angle, &P::set_angle);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<scene::Camera> s, proto::Camera& p) {
    using enum scene::Camera::Field;
    using P = proto::Camera;
    if (io.has(Name)) io.text(s.name, p.mutable_name());
    if (io.has(VerticalFov)) io(s.vertical_fov, p, &P::vertical_fov, &P::set_vertical_fov);
    if (io.has(AspectRatio)) io(s.aspect_ratio, p, &P::aspect_ratio, &P::set_aspect_ratio);
    if (io.has(Projection)) io(s.projection, p, &P::projection, &P::set_projection);
    if (io.has(OrthographicHeight))
        io(s.orthographic_height, p, &P::orthographic_height, &P::set_orthographic_height);
    if (io.has(LensRadius)) io(s.lens_radius, p, &P::lens_radius, &P::set_lens_radius);
    if (io.has(FocusDistance)) io(s.focus_distance, p, &P::focus_distance, &P::set_focus_distance);
    if (io.has(Aperture)) io(s.aperture, p, &P::aperture, &P::set_aperture);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<scene::Background> s, proto::Background& p) {
    using enum scene::Background::Field;
    using P = proto::Background;
    if (io.has(Name)) io.text(s.name, p.mutable_name());
    if (io.has(Color)) io.vector(s.color, p.mutable_color());
    if (io.has(Environment)) io(s.environment, p, &P::environment, &P::set_environment);
    if (io.has(Strength)) io(s.strength, p, &P::strength, &P::set_strength);
    if (io.has(Rotation)) io(s.rotation, p, &P::rotation, &P::set_rotation);
    if (io.has(Visible)) io(s.visible, p, &P::visible, &P::set_visible);
    if (io.has(VisibleColor)) io.vector(s.visible_color, p.mutable_visible_color());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<scene::Attachment> s, proto::Attachment& p) {
    using enum scene::Attachment::Field;
    if (io.has(Name)) io.text(s.name, p.mutable_name());
    if (io.has(Key)) io.text(s.key, p.mutable_key());
    if (io.has(Value)) io.text(s.value, p.mutable_value());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<scene::SurfaceShader> s, proto::SurfaceShader& p) {
    using enum scene::SurfaceShader::Field;
    using P = proto::SurfaceShader;
    if (io.has(Name)) io.text(s.name, p.mutable_name());
    if (io.has(Emission)) io.vector(s.emission, p.mutable_emission());
    if (io.has(EmissionTexture)) io.message(s.emission_texture, p.mutable_emission_texture());
    if (io.has(Ambient)) io.vector(s.ambient, p.mutable_ambient());
    if (io.has(AmbientTexture)) io.message(s.ambient_texture, p.mutable_ambient_texture());
    if (io.has(Diffuse)) io.vector(s.diffuse, p.mutable_diffuse());
    if (io.has(DiffuseTexture)) io.message(s.diffuse_texture, p.mutable_diffuse_texture());
    if (io.has(Specular)) io.vector(s.specular, p.mutable_specular());
    if (io.has(SpecularTexture)) io.message(s.specular_texture, p.mutable_specular_texture());
    if (io.has(Shininess)) io.vector(s.shininess, p.mutable_shininess());
    if (io.has(ShininessTexture)) io.message(s.shininess_texture, p.mutable_shininess_texture());
    if (io.has(Alpha)) io(s.alpha, p, &P::alpha, &P::set_alpha);
    if (io.has(AlphaTexture)) io.message(s.alpha_texture, p.mutable_alpha_texture());
    if (io.has(InvertAlphaTexture))
        io(s.invert_alpha_texture, p, &P::invert_alpha_texture, &P::set_invert_alpha_texture);
    if (io.has(NormalTexture)) io.message(s.normal_texture, p.mutable_normal_texture());
    if (io.has(NormalFormat)) io(s.normal_format, p, &P::normal_format, &P::set_normal_format);
    if (io.has(NormalSpace)) io(s.normal_space, p, &P::normal_space, &P::set_normal_space);
    if (io.has(NormalScale)) io.vector(s.normal_scale, p.mutable_normal_scale());
    if (io.has(NormalBias)) io.vector(s.normal_bias, p.mutable_normal_bias());
    if (io.has(HeightTexture)) io.message(s.height_texture, p.mutable_height_texture());
    if (io.has(HeightScale)) io(s.height_scale, p, &P::height_scale, &P::set_height_scale);
    if (io.has(Reflection)) io.vector(s.reflection, p.mutable_reflection());
    if (io.has(ReflectionTexture)) io.message(s.reflection_texture, p.mutable_reflection_texture());
    if (io.has(Transmission)) io.vector(s.transmission, p.mutable_transmission());
    if (io.has(TransmissionTexture)) io.message(s.transmission_texture, p.mutable_transmission_texture());
    if (io.has(RelativeIndexOfRefraction))
        io.vector(s.relative_index_of_refraction, p.mutable_relative_index_of_refraction());
    if (io.has(FresnelBlend)) io(s.fresnel_blend, p, &P::fresnel_blend, &P::set_fresnel_blend);
    if (io.has(TangentTexCoords))
        io(s.tangent_tex_coords, p, &P::tangent_tex_coords, &P::set_tangent_tex_coords);
    if (io.has(BinormalTexCoords))
        io(s.binormal_tex_coords, p, &P::binormal_tex_coords, &P::set_binormal_tex_coords);
    if (io.has(Environment)) io.vector(s.environment, p.mutable_environment());
    if (io.has(EnvironmentTexture)) io.message(s.environment_texture, p.mutable_environment_texture());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<scene::Medium> s, proto::Medium& p) {
    using enum scene::Medium::Field;
    using P = proto::Medium;
    if (io.has(Name)) io.text(s.name, p.mutable_name());
    if (io.has(Emission)) io.vector(s.emission, p.mutable_emission());
    if (io.has(EmissionTexture)) io.message(s.emission_texture, p.mutable_emission_texture());
    if (io.has(Absorption)) io.vector(s.absorption, p.mutable_absorption());
    if (io.has(AbsorptionTexture)) io.message(s.absorption_texture, p.mutable_absorption_texture());
    if (io.has(Scattering)) io.vector(s.scattering, p.mutable_scattering());
    if (io.has(ScatteringTexture)) io.message(s.scattering_texture, p.mutable_scattering_texture());
    if (io.has(Anisotropy)) io(s.anisotropy, p, &P::anisotropy, &P::set_anisotropy);
    if (io.has(Priority)) io(s.priority, p, &P::priority, &P::set_priority);
}

}  // namespace tessera::wire
