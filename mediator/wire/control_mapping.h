#pragma once

#include "mediator/wire/session_mapping.h"
#include "proto/control.pb.h"

// Private to wire/*.cpp: how peers greet, keep in touch and follow the scene.
namespace tessera::wire {

template <>
constexpr PeerKind last_of() {
    return PeerKind::Node;
}
template <>
constexpr Severity last_of() {
    return Severity::Error;
}

inline void map(const Writer&, const Changes& s, proto::Changes& p) {
    write(s.list, *p.mutable_list());
}
inline void map(const Reader&, Changes& s, proto::Changes& p) {
    read(*p.mutable_list(), s.list);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<Hello> s, proto::Hello& p) {
    using P = proto::Hello;
    io(s.protocol, p, &P::protocol, &P::set_protocol);
    io(s.peer, p, &P::peer, &P::set_peer);
    io.text(s.name, p.mutable_name());
    io.text(s.host, p.mutable_host());
    io.text(s.software, p.mutable_software());
    io(s.pid, p, &P::pid, &P::set_pid);
    io.text(s.backend, p.mutable_backend());
    io.text(s.kind, p.mutable_kind());
    map_channels(io, s.channels, p, &P::channels, &P::set_channels);
    io(s.preferred_tile, p, &P::preferred_tile, &P::set_preferred_tile);
    io(s.concurrent_units, p, &P::concurrent_units, &P::set_concurrent_units);
    io(s.reproducible, p, &P::reproducible, &P::set_reproducible);
    io(s.resume_token, p, &P::resume_token, &P::set_resume_token);
    map_renderers(io, s.renderers, p, &P::renderers, &P::set_renderers);
    io(s.render_revision, p, &P::render_revision, &P::set_render_revision);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<Welcome> s, proto::Welcome& p) {
    using P = proto::Welcome;
    io(s.peer_number, p, &P::peer_number, &P::set_peer_number);
    io(s.token, p, &P::token, &P::set_token);
    io(s.epoch, p, &P::epoch, &P::set_epoch);
    io(s.heartbeat_interval, p, &P::heartbeat_interval, &P::set_heartbeat_interval);
    io(s.missed_heartbeats, p, &P::missed_heartbeats, &P::set_missed_heartbeats);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<Refusal> s, proto::Refusal& p) {
    io.text(s.reason, p.mutable_reason());
}

template <class Io>
void map(const Io&, typename Io::template Ref<Unknown>, proto::Unknown&) {}

template <class Io>
void map(const Io& io, typename Io::template Ref<Heartbeat> s, proto::Heartbeat& p) {
    using P = proto::Heartbeat;
    io(s.sent_at, p, &P::sent_at, &P::set_sent_at);
    io(s.echo_sent_at, p, &P::echo_sent_at, &P::set_echo_sent_at);
    io(s.echo_delay, p, &P::echo_delay, &P::set_echo_delay);
    io(s.phase, p, &P::phase, &P::set_phase);
    io(s.progress, p, &P::progress, &P::set_progress);
    io.message(s.version, p.mutable_version());
    io.list(s.in_hand, p.mutable_in_hand(), MaxList);
    io(s.free_places, p, &P::free_places, &P::set_free_places);
    io(s.last_work_sequence, p, &P::last_work_sequence, &P::set_last_work_sequence);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<ChangesByBlob> s, proto::ChangesByBlob& p) {
    io.message(s.from, p.mutable_from());
    io.message(s.to, p.mutable_to());
    io.message(s.blob, p.mutable_blob());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<VersionReport> s, proto::VersionReport& p) {
    using P = proto::VersionReport;
    io.message(s.version, p.mutable_version());
    io.message(s.state_hash, p.mutable_state_hash());
    io(s.triangles, p, &P::triangles, &P::set_triangles);
    io(s.instances, p, &P::instances, &P::set_instances);
    io(s.lights, p, &P::lights, &P::set_lights);
    io(s.degenerate_triangles, p, &P::degenerate_triangles, &P::set_degenerate_triangles);
    io(s.entries, p, &P::entries, &P::set_entries);
    io(s.relevant, p, &P::relevant, &P::set_relevant);
    io(s.rebuilt, p, &P::rebuilt, &P::set_rebuilt);
    io(s.refitted, p, &P::refitted, &P::set_refitted);
    io(s.retransformed, p, &P::retransformed, &P::set_retransformed);
    io.texts(s.ignored_kinds, p.mutable_ignored_kinds(), MaxList);
    io.texts(s.problems, p.mutable_problems(), MaxList);
    io(s.received_at, p, &P::received_at, &P::set_received_at);
    io(s.built_at, p, &P::built_at, &P::set_built_at);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<Resync> s, proto::Resync& p) {
    io.message(s.version, p.mutable_version());
    io.text(s.reason, p.mutable_reason());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<SceneRefused> s, proto::SceneRefused& p) {
    io.message(s.version, p.mutable_version());
    io.text(s.reason, p.mutable_reason());
}

template <class Io>
void map(const Io&, typename Io::template Ref<Leave>, proto::Leave&) {}

template <class Io>
void map(const Io& io, typename Io::template Ref<Goodbye> s, proto::Goodbye& p) {
    io.text(s.reason, p.mutable_reason());
    io.list(s.units_sent, p.mutable_units_sent(), MaxList);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<Notice> s, proto::Notice& p) {
    using P = proto::Notice;
    io(s.severity, p, &P::severity, &P::set_severity);
    io.text(s.text, p.mutable_text());
}

}  // namespace tessera::wire
