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
    return scene::LightKind::Directional;
}

inline constexpr std::size_t MaxChildren = 16'000'000;

template <class Io>
void map(const Io& io, typename Io::template Ref<scene::TextureSlot> s, proto::TextureSlot& p) {
    using P = proto::TextureSlot;
    io(s.texture, p, &P::texture, &P::set_texture);
    io.vector(s.offset, p.mutable_offset());
    io.vector(s.scale, p.mutable_scale());
    io(s.rotation, p, &P::rotation, &P::set_rotation);
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
}

template <class Io>
void map(const Io& io, typename Io::template Ref<scene::Camera> s, proto::Camera& p) {
    using enum scene::Camera::Field;
    using P = proto::Camera;
    if (io.has(Name)) io.text(s.name, p.mutable_name());
    if (io.has(VerticalFov)) io(s.vertical_fov, p, &P::vertical_fov, &P::set_vertical_fov);
    if (io.has(AspectRatio)) io(s.aspect_ratio, p, &P::aspect_ratio, &P::set_aspect_ratio);
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
}

template <class Io>
void map(const Io& io, typename Io::template Ref<scene::Attachment> s, proto::Attachment& p) {
    using enum scene::Attachment::Field;
    if (io.has(Name)) io.text(s.name, p.mutable_name());
    if (io.has(Key)) io.text(s.key, p.mutable_key());
    if (io.has(Value)) io.text(s.value, p.mutable_value());
}

}  // namespace tessera::wire
