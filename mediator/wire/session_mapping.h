#pragma once

#include "mediator/wire/display_mapping.h"
#include "mediator/wire/live_mapping.h"
#include "proto/session.pb.h"

// Private to wire/*.cpp: what clients and the master say to each other.
namespace tessera::wire {

template <>
constexpr Policy last_of() {
    return Policy::Mixed;
}
template <>
constexpr JobPhase last_of() {
    return JobPhase::Filtering;
}
template <>
constexpr JobOutcome last_of() {
    return JobOutcome::Failed;
}
template <>
constexpr NodePhase last_of() {
    return NodePhase::Leaving;
}

inline void map(const Writer&, const SubmitEdit& s, proto::SubmitEdit& p) {
    write(s.edit, *p.mutable_edit());
}
inline void map(const Reader&, SubmitEdit& s, proto::SubmitEdit& p) {
    read(*p.mutable_edit(), s.edit);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<OpenScene> s, proto::OpenScene& p) {
    using P = proto::OpenScene;
    io.text(s.title, p.mutable_title());
    io(s.no_wait, p, &P::no_wait, &P::set_no_wait);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<QueuePlace> s, proto::QueuePlace& p) {
    using P = proto::QueuePlace;
    io(s.place, p, &P::place, &P::set_place);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<SceneOpened> s, proto::SceneOpened& p) {
    using P = proto::SceneOpened;
    io.message(s.version, p.mutable_version());
    io(s.first_id, p, &P::first_id, &P::set_first_id);
    io(s.id_count, p, &P::id_count, &P::set_id_count);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<SubmitEditByBlob> s, proto::SubmitEditByBlob& p) {
    using P = proto::SubmitEditByBlob;
    io(s.session, p, &P::session, &P::set_session);
    io(s.sequence, p, &P::sequence, &P::set_sequence);
    io.message(s.base, p.mutable_base());
    io.message(s.blob, p.mutable_blob());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<EditReply> s, proto::EditReply& p) {
    using P = proto::EditReply;
    io(s.sequence, p, &P::sequence, &P::set_sequence);
    io(s.accepted, p, &P::accepted, &P::set_accepted);
    io.message(s.version, p.mutable_version());
    io.texts(s.problems, p.mutable_problems(), MaxList);
    io(s.transaction, p, &P::transaction, &P::set_transaction);
    io.texts(s.notes, p.mutable_notes(), MaxList);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<StartJob> s, proto::StartJob& p) {
    using P = proto::StartJob;
    io(s.job, p, &P::job, &P::set_job);
    io.message(s.view, p.mutable_view());
    io(s.spp, p, &P::spp, &P::set_spp);
    io(s.time_limit, p, &P::time_limit, &P::set_time_limit);
    io(s.policy, p, &P::policy, &P::set_policy);
    io(s.reproducible, p, &P::reproducible, &P::set_reproducible);
    io(s.tile, p, &P::tile, &P::set_tile);
    io(s.wait_nodes, p, &P::wait_nodes, &P::set_wait_nodes);
    io(s.wait_limit, p, &P::wait_limit, &P::set_wait_limit);
    io(s.picture, p, &P::picture, &P::set_picture);
    io(s.film, p, &P::film, &P::set_film);
    io(s.budget, p, &P::budget, &P::set_budget);
    io(s.adapts_size, p, &P::adapts_size, &P::set_adapts_size);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<StopJob> s, proto::StopJob& p) {
    using P = proto::StopJob;
    io(s.job, p, &P::job, &P::set_job);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<JobProgress> s, proto::JobProgress& p) {
    using P = proto::JobProgress;
    io(s.job, p, &P::job, &P::set_job);
    io(s.phase, p, &P::phase, &P::set_phase);
    io(s.samples, p, &P::samples, &P::set_samples);
    io(s.samples_expected, p, &P::samples_expected, &P::set_samples_expected);
    io(s.rays, p, &P::rays, &P::set_rays);
    io(s.nodes, p, &P::nodes, &P::set_nodes);
    io(s.elapsed, p, &P::elapsed, &P::set_elapsed);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<NodeSummary> s, proto::NodeSummary& p) {
    using P = proto::NodeSummary;
    io(s.id, p, &P::id, &P::set_id);
    io.text(s.name, p.mutable_name());
    io.text(s.host, p.mutable_host());
    io.text(s.backend, p.mutable_backend());
    io.text(s.kind, p.mutable_kind());
    io(s.pid, p, &P::pid, &P::set_pid);
    io(s.units, p, &P::units, &P::set_units);
    io(s.samples, p, &P::samples, &P::set_samples);
    io(s.seconds_busy, p, &P::seconds_busy, &P::set_seconds_busy);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<UnitCounts> s, proto::UnitCounts& p) {
    using P = proto::UnitCounts;
    io(s.issued, p, &P::issued, &P::set_issued);
    io(s.reissued, p, &P::reissued, &P::set_reissued);
    io(s.merged, p, &P::merged, &P::set_merged);
    io(s.duplicate, p, &P::duplicate, &P::set_duplicate);
    io(s.cancelled, p, &P::cancelled, &P::set_cancelled);
    io(s.refused, p, &P::refused, &P::set_refused);
    io(s.lost, p, &P::lost, &P::set_lost);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<WireBytes> s, proto::WireBytes& p) {
    using P = proto::WireBytes;
    io(s.control, p, &P::control, &P::set_control);
    io(s.blobs, p, &P::blobs, &P::set_blobs);
    io(s.film, p, &P::film, &P::set_film);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<FilterPass> s, proto::FilterPass& p) {
    using P = proto::FilterPass;
    io.text(s.name, p.mutable_name());
    io(s.seconds, p, &P::seconds, &P::set_seconds);
    io(s.bytes_per_pixel, p, &P::bytes_per_pixel, &P::set_bytes_per_pixel);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<PictureSummary> s, proto::PictureSummary& p) {
    using P = proto::PictureSummary;
    io(s.encoding, p, &P::encoding, &P::set_encoding);
    io(s.width, p, &P::width, &P::set_width);
    io(s.height, p, &P::height, &P::set_height);
    io(s.components, p, &P::components, &P::set_components);
    io(s.byte_size, p, &P::byte_size, &P::set_byte_size);
    io.text(s.filter, p.mutable_filter());
    io(s.scale, p, &P::scale, &P::set_scale);
    io(s.seconds_filter, p, &P::seconds_filter, &P::set_seconds_filter);
    io(s.seconds_encode, p, &P::seconds_encode, &P::set_seconds_encode);
    io(s.seconds_predicted, p, &P::seconds_predicted, &P::set_seconds_predicted);
    io.messages(s.passes, p.mutable_passes(), MaxList);
    io.texts(s.notes, p.mutable_notes(), MaxList);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<JobDone> s, proto::JobDone& p) {
    using P = proto::JobDone;
    io(s.job, p, &P::job, &P::set_job);
    io(s.outcome, p, &P::outcome, &P::set_outcome);
    io.text(s.message, p.mutable_message());
    io(s.tiles, p, &P::tiles, &P::set_tiles);
    io.message(s.version, p.mutable_version());
    io(s.seed, p, &P::seed, &P::set_seed);
    io(s.seconds_render, p, &P::seconds_render, &P::set_seconds_render);
    io(s.first_picture_seconds, p, &P::first_picture_seconds, &P::set_first_picture_seconds);
    io(s.rays, p, &P::rays, &P::set_rays);
    io(s.samples, p, &P::samples, &P::set_samples);
    io(s.nonfinite_samples, p, &P::nonfinite_samples, &P::set_nonfinite_samples);
    io(s.triangles, p, &P::triangles, &P::set_triangles);
    io(s.instances, p, &P::instances, &P::set_instances);
    io(s.lights, p, &P::lights, &P::set_lights);
    io.messages(s.nodes, p.mutable_nodes(), MaxList);
    io.message(s.units, p.mutable_units());
    io.message(s.wire_bytes, p.mutable_wire_bytes());
    io.message(s.picture, p.mutable_picture());
    io(s.samples_least, p, &P::samples_least, &P::set_samples_least);
    io(s.samples_most, p, &P::samples_most, &P::set_samples_most);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<SetFilter> s, proto::SetFilter& p) {
    io.text(s.filter, p.mutable_filter());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<FilterSet> s, proto::FilterSet& p) {
    using P = proto::FilterSet;
    io(s.accepted, p, &P::accepted, &P::set_accepted);
    io.text(s.text, p.mutable_text());
}

template <class Io>
void map(const Io&, typename Io::template Ref<StatusRequest>, proto::StatusRequest&) {}

template <class Io>
void map(const Io& io, typename Io::template Ref<NodeStatus> s, proto::NodeStatus& p) {
    using P = proto::NodeStatus;
    io.message(s.summary, p.mutable_summary());
    io(s.phase, p, &P::phase, &P::set_phase);
    io.message(s.version, p.mutable_version());
    io(s.units_in_hand, p, &P::units_in_hand, &P::set_units_in_hand);
    io(s.samples_per_second, p, &P::samples_per_second, &P::set_samples_per_second);
    io(s.round_trip_seconds, p, &P::round_trip_seconds, &P::set_round_trip_seconds);
    io(s.stuck, p, &P::stuck, &P::set_stuck);
    io(s.clock_offset_seconds, p, &P::clock_offset_seconds, &P::set_clock_offset_seconds);
    io(s.clock_bound_seconds, p, &P::clock_bound_seconds, &P::set_clock_bound_seconds);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<StatusReply> s, proto::StatusReply& p) {
    using P = proto::StatusReply;
    io.text(s.software, p.mutable_software());
    io.message(s.version, p.mutable_version());
    io(s.uptime_seconds, p, &P::uptime_seconds, &P::set_uptime_seconds);
    io(s.blobs, p, &P::blobs, &P::set_blobs);
    io(s.blob_bytes, p, &P::blob_bytes, &P::set_blob_bytes);
    io(s.sessions, p, &P::sessions, &P::set_sessions);
    io(s.queued, p, &P::queued, &P::set_queued);
    io(s.dropped_messages, p, &P::dropped_messages, &P::set_dropped_messages);
    io.message(s.units, p.mutable_units());
    io.message(s.wire_bytes, p.mutable_wire_bytes());
    io.messages(s.nodes, p.mutable_nodes(), MaxList);
    io.message(s.live, p.mutable_live());
    io(s.resyncs, p, &P::resyncs, &P::set_resyncs);
    io.message(s.display, p.mutable_display());
}

}  // namespace tessera::wire
