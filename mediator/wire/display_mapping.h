#pragma once

#include <array>

#include "mediator/wire/display_messages.h"
#include "mediator/wire/work_mapping.h"
#include "proto/display.pb.h"

// Private to wire/*.cpp.
namespace tessera::wire {

template <>
constexpr display::Grid::Nodes last_of() {
    return display::Grid::Nodes::Centres;
}
template <>
constexpr display::Turn last_of() {
    return display::Turn::ThreeQuarters;
}
template <>
constexpr display::Stereo last_of() {
    return display::Stereo::AnaglyphDubois;
}
template <>
constexpr OutputState last_of() {
    return OutputState::Late;
}

template <class Io>
void map(const Io& io, typename Io::template Ref<display::Grid> s, proto::DisplayGrid& p) {
    using P = proto::DisplayGrid;
    io(s.columns, p, &P::columns, &P::set_columns);
    io(s.rows, p, &P::rows, &P::set_rows);
    io(s.components, p, &P::components, &P::set_components);
    io(s.nodes, p, &P::nodes, &P::set_nodes);
    io.message(s.values, p.mutable_values());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<display::ViewPlane> s, proto::ViewPlane& p) {
    io.vector(s.origin, p.mutable_origin());
    io.vector(s.right, p.mutable_right());
    io.vector(s.up, p.mutable_up());
    if constexpr (std::is_same_v<Io, Writer>) {
        for (const glm::dvec3& point : s.hull) io.vector(point, p.mutable_hull());
    } else {
        const auto& values = p.hull();
        if (values.size() % 3 != 0 || static_cast<std::size_t>(values.size()) > 3 * display::MaxHull)
            malformed("a hull is too long or has half a point");
        for (int i = 0; i < values.size(); i += 3)
            s.hull.emplace_back(values[i], values[i + 1], values[i + 2]);
    }
}

template <class Io>
void map(const Io& io, typename Io::template Ref<display::Blend> s, proto::OutputBlend& p) {
    using P = proto::OutputBlend;
    io(s.left, p, &P::left, &P::set_left);
    io(s.right, p, &P::right, &P::set_right);
    io(s.top, p, &P::top, &P::set_top);
    io(s.bottom, p, &P::bottom, &P::set_bottom);
    io(s.shape, p, &P::shape, &P::set_shape);
    io.message(s.weights, p.mutable_weights());
    io.message(s.lift, p.mutable_lift());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<display::Color> s, proto::OutputColor& p) {
    using P = proto::OutputColor;
    if constexpr (std::is_same_v<Io, Writer>) {
        for (int column = 0; column < 3; ++column) io.vector(s.matrix[column], p.mutable_matrix());
        p.mutable_curve()->Assign(s.curve.begin(), s.curve.end());
    } else {
        if (p.matrix_size() != 9) malformed("a colour matrix does not have 9 numbers");
        for (int i = 0; i < 9; ++i) s.matrix[i / 3][i % 3] = p.matrix(i);
        if (static_cast<std::size_t>(p.curve_size()) > display::MaxCurve) malformed("a curve is too long");
        s.curve.assign(p.curve().begin(), p.curve().end());
    }
    io.vector(s.gain, p.mutable_gain());
    io(s.gamma, p, &P::gamma, &P::set_gamma);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<display::Output> s, proto::DisplayOutput& p) {
    using P = proto::DisplayOutput;
    io.text(s.name, p.mutable_name());
    io(s.width, p, &P::width, &P::set_width);
    io(s.height, p, &P::height, &P::set_height);
    io(s.x, p, &P::x, &P::set_x);
    io(s.y, p, &P::y, &P::set_y);
    io(s.turn, p, &P::turn, &P::set_turn);
    io(s.stereo, p, &P::stereo, &P::set_stereo);
    io(s.priority, p, &P::priority, &P::set_priority);
    io.message(s.plane, p.mutable_plane());
    io(s.view_width, p, &P::view_width, &P::set_view_width);
    io(s.view_height, p, &P::view_height, &P::set_view_height);
    io.message(s.points, p.mutable_points());
    io.message(s.blend, p.mutable_blend());
    io.message(s.color, p.mutable_color());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<display::Layer> s, proto::DisplayLayer& p) {
    using P = proto::DisplayLayer;
    io.text(s.name, p.mutable_name());
    io(s.renderer, p, &P::renderer, &P::set_renderer);
    io(s.layers, p, &P::layers, &P::set_layers);
    io(s.shown, p, &P::shown, &P::set_shown);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<display::Head> s, proto::DisplayHead& p) {
    io.vector(s.position, p.mutable_position());
    glm::dvec4 turned{s.orientation.w, s.orientation.x, s.orientation.y, s.orientation.z};
    io.vector(turned, p.mutable_orientation());
    if constexpr (std::is_same_v<Io, Reader>) {
        const double length = glm::length(turned);
        const glm::dvec3 zero(0.0);
        if (!(glm::dot(s.position - s.position, s.position - s.position) == 0.0) || !(length > 0.5) ||
            !(length < 2.0))
            malformed("a head is nowhere, or its orientation is no unit quaternion");
        turned /= length;
        s.orientation = glm::dquat(turned.x, turned.y, turned.z, turned.w);
    }
}

template <class Io>
void map(const Io& io, typename Io::template Ref<display::Display> s, proto::Display& p) {
    using P = proto::Display;
    io.text(s.name, p.mutable_name());
    io.text(s.camera, p.mutable_camera());
    io(s.units_per_metre, p, &P::units_per_metre, &P::set_units_per_metre);
    io.message(s.head, p.mutable_head());
    io(s.eye_separation, p, &P::eye_separation, &P::set_eye_separation);
    io(s.zero_parallax, p, &P::zero_parallax, &P::set_zero_parallax);
    io(s.spp, p, &P::spp, &P::set_spp);
    io(s.coarsest, p, &P::coarsest, &P::set_coarsest);
    io(s.max_bounces, p, &P::max_bounces, &P::set_max_bounces);
    io(s.rate, p, &P::rate, &P::set_rate);
    io.text(s.filter, p.mutable_filter());
    io(s.exposure, p, &P::exposure, &P::set_exposure);
    io(s.white, p, &P::white, &P::set_white);
    io(s.stereo_difference, p, &P::stereo_difference, &P::set_stereo_difference);
    io.messages(s.layers, p.mutable_layers(), display::MaxLayers);
    io.messages(s.outputs, p.mutable_outputs(), display::MaxOutputs);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<OpenDisplay> s, proto::OpenDisplay& p) {
    using P = proto::OpenDisplay;
    io(s.request, p, &P::request, &P::set_request);
    io.message(s.description, p.mutable_description());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<CloseDisplay> s, proto::CloseDisplay& p) {
    using P = proto::CloseDisplay;
    io(s.request, p, &P::request, &P::set_request);
}

// A value that may be missing.
template <class Io, class T, class P, class N>
void map_optional(const Io& io, T& s, P& p, bool has, N (P::*get)() const, void (P::*set)(N)) {
    if constexpr (std::is_same_v<Io, Writer>) {
        if (s) io(*s, p, get, set);
    } else if (has) {
        io(s.emplace(), p, get, set);
    }
}

template <class Io>
void map(const Io& io, typename Io::template Ref<AdjustDisplay> s, proto::AdjustDisplay& p) {
    using P = proto::AdjustDisplay;
    io(s.request, p, &P::request, &P::set_request);
    map_optional(io, s.eye_separation, p, p.has_eye_separation(), &P::eye_separation, &P::set_eye_separation);
    map_optional(io, s.zero_parallax, p, p.has_zero_parallax(), &P::zero_parallax, &P::set_zero_parallax);
    map_optional(io, s.exposure, p, p.has_exposure(), &P::exposure, &P::set_exposure);
    map_optional(io, s.pattern, p, p.has_pattern(), &P::pattern, &P::set_pattern);
    map_optional(io, s.shown_layers, p, p.has_shown_layers(), &P::shown_layers, &P::set_shown_layers);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<MoveHead> s, proto::MoveHead& p) {
    io.message(s.head, p.mutable_head());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<JoinOutput> s, proto::JoinOutput& p) {
    using P = proto::JoinOutput;
    io(s.request, p, &P::request, &P::set_request);
    io.text(s.name, p.mutable_name());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<OutputOpened> s, proto::OutputOpened& p) {
    using P = proto::OutputOpened;
    io(s.request, p, &P::request, &P::set_request);
    io.message(s.description, p.mutable_description());
    io(s.index, p, &P::index, &P::set_index);
    io(s.pattern, p, &P::pattern, &P::set_pattern);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<OutputReady> s, proto::OutputReady& p) {
    io(s.frame, p, &proto::OutputReady::frame, &proto::OutputReady::set_frame);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<PresentFrame> s, proto::PresentFrame& p) {
    using P = proto::PresentFrame;
    io(s.frame, p, &P::frame, &P::set_frame);
    io.message(s.version, p.mutable_version());
    io(s.at, p, &P::at, &P::set_at);
    io(s.bound, p, &P::bound, &P::set_bound);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<OutputStatus> s, proto::OutputStatus& p) {
    using P = proto::OutputStatus;
    io.text(s.name, p.mutable_name());
    io.text(s.host, p.mutable_host());
    io(s.state, p, &P::state, &P::set_state);
    io(s.frames, p, &P::frames, &P::set_frames);
    io(s.late, p, &P::late, &P::set_late);
    io(s.stereo_difference, p, &P::stereo_difference, &P::set_stereo_difference);
    io(s.samples, p, &P::samples, &P::set_samples);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<DisplayStatus> s, proto::DisplayStatus& p) {
    using P = proto::DisplayStatus;
    io.text(s.name, p.mutable_name());
    io(s.frames, p, &P::frames, &P::set_frames);
    io.message(s.version, p.mutable_version());
    io(s.rate, p, &P::rate, &P::set_rate);
    io.messages(s.outputs, p.mutable_outputs(), display::MaxOutputs);
}

}  // namespace tessera::wire
