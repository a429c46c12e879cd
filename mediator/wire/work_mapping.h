#pragma once

#include "mediator/wire/common_mapping.h"
#include "mediator/wire/messages.h"
#include "proto/work.pb.h"

// Private to wire/*.cpp: views, units and what is said about them.
namespace tessera::wire {

template <>
constexpr view::Eye last_of() {
    return view::Eye::Right;
}
template <>
constexpr view::PixelFilterKind last_of() {
    return view::PixelFilterKind::BlackmanHarris;
}
template <>
constexpr view::Renderer last_of() {
    return view::Renderer::Coverage;
}
template <>
constexpr view::PathClass last_of() {
    return view::PathClass::None;
}
template <>
constexpr view::FeatureRule last_of() {
    return view::FeatureRule::Connections;
}
template <>
constexpr ReleaseReason last_of() {
    return ReleaseReason::Failed;
}

inline constexpr std::size_t MaxList = 65536;  // a control message has 64 KiB

// A set of bits, each of which is known.
template <class Set, class Io>
void map_set(const Io& io, typename Io::template Ref<Set> s, auto& p, auto get, auto set,
             const char* unknown) {
    std::uint32_t bits = s.bits();
    io(bits, p, get, set);
    if constexpr (!std::is_same_v<Io, Writer>) {
        s = Set::from_bits(bits);
        if (s.bits() != bits) malformed(unknown);
    }
}
template <class Io>
void map_channels(const Io& io, typename Io::template Ref<frame::ChannelSet> s, auto& p, auto get, auto set) {
    map_set<frame::ChannelSet>(io, s, p, get, set, "a channel is unknown");
}
template <class Io>
void map_renderers(const Io& io, typename Io::template Ref<view::RendererSet> s, auto& p, auto get,
                   auto set) {
    map_set<view::RendererSet>(io, s, p, get, set, "a renderer is unknown");
}

template <class Io>
void map(const Io& io, typename Io::template Ref<view::View> s, proto::View& p) {
    using P = proto::View;
    io(s.id, p, &P::id, &P::set_id);
    io(s.revision, p, &P::revision, &P::set_revision);
    io.matrix(s.camera.world_from_camera, p.mutable_world_from_camera());
    glm::dvec4 frustum{s.camera.left, s.camera.right, s.camera.bottom, s.camera.top};
    io.vector(frustum, p.mutable_frustum());
    if constexpr (std::is_same_v<Io, Reader>) {
        s.camera.left = frustum.x;
        s.camera.right = frustum.y;
        s.camera.bottom = frustum.z;
        s.camera.top = frustum.w;
    }
    io(s.camera.projection, p, &P::projection, &P::set_projection);
    io(s.camera.lens_radius, p, &P::lens_radius, &P::set_lens_radius);
    io(s.camera.focus_distance, p, &P::focus_distance, &P::set_focus_distance);
    io(s.camera.aperture, p, &P::aperture, &P::set_aperture);
    io.matrices(s.camera.motion, p.mutable_camera_motion(), MaxSteps);
    io(s.eye, p, &P::eye, &P::set_eye);
    io(s.width, p, &P::width, &P::set_width);
    io(s.height, p, &P::height, &P::set_height);
    io.message(s.window, p.mutable_window());
    io(s.seed, p, &P::seed, &P::set_seed);
    io(s.max_bounces, p, &P::max_bounces, &P::set_max_bounces);
    io(s.pixel_filter.kind, p, &P::pixel_filter, &P::set_pixel_filter);
    io(s.pixel_filter.radius, p, &P::filter_radius, &P::set_filter_radius);
    io(s.renderer, p, &P::renderer, &P::set_renderer);
    io(s.path_class, p, &P::path_class, &P::set_path_class);
    io(s.feature_rule, p, &P::feature_rule, &P::set_feature_rule);
    io(s.transparent_background, p, &P::transparent_background, &P::set_transparent_background);
    map_channels(io, s.channels, p, &P::channels, &P::set_channels);
    io.text(s.filter, p.mutable_filter());
    std::uint32_t hidden = ~s.layers;
    io(hidden, p, &P::hidden_layers, &P::set_hidden_layers);
    if constexpr (std::is_same_v<Io, Reader>) s.layers = ~hidden;
}

template <class Io>
void map(const Io& io, typename Io::template Ref<view::WorkUnit> s, proto::WorkUnit& p) {
    using P = proto::WorkUnit;
    io(s.id, p, &P::id, &P::set_id);
    io(s.view, p, &P::view, &P::set_view);
    io(s.revision, p, &P::revision, &P::set_revision);
    io.message(s.version, p.mutable_version());
    io.message(s.tile, p.mutable_tile());
    io.message(s.block, p.mutable_block());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<OpenView> s, proto::OpenView& p) {
    io.message(s.view, p.mutable_view());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<CloseView> s, proto::CloseView& p) {
    using P = proto::CloseView;
    io(s.view, p, &P::view, &P::set_view);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<Work> s, proto::Work& p) {
    using P = proto::Work;
    io(s.sequence, p, &P::sequence, &P::set_sequence);
    io.message(s.unit, p.mutable_unit());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<CancelUnits> s, proto::CancelUnits& p) {
    io.list(s.units, p.mutable_units(), MaxList);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<UnitReleased> s, proto::UnitReleased& p) {
    using P = proto::UnitReleased;
    io(s.unit, p, &P::unit, &P::set_unit);
    io(s.reason, p, &P::reason, &P::set_reason);
    io.text(s.message, p.mutable_message());
}

}  // namespace tessera::wire
