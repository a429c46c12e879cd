#pragma once

#include "mediator/wire/scene_codec.h"
#include "mediator/wire/work_mapping.h"
#include "proto/live.pb.h"

// Private to wire/*.cpp: what members of a live scene and the master say to each other.
namespace tessera::wire {

template <>
constexpr PictureEncoding last_of() {
    return PictureEncoding::Exr;
}

inline void map(const Writer& io, const SceneContent& s, proto::SceneContent& p) {
    p.set_request(s.request);
    write(s.list, *p.mutable_list());
    io.message(s.blob, p.mutable_blob());
}
inline void map(const Reader& io, SceneContent& s, proto::SceneContent& p) {
    s.request = p.request();
    read(*p.mutable_list(), s.list);
    io.message(s.blob, p.mutable_blob());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<JoinScene> s, proto::JoinScene& p) {
    using P = proto::JoinScene;
    io.text(s.title, p.mutable_title());
    io.text(s.name, p.mutable_name());
    io(s.key, p, &P::key, &P::set_key);
    io(s.no_wait, p, &P::no_wait, &P::set_no_wait);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<SceneJoined> s, proto::SceneJoined& p) {
    using P = proto::SceneJoined;
    io.message(s.version, p.mutable_version());
    io(s.first_id, p, &P::first_id, &P::set_first_id);
    io(s.id_count, p, &P::id_count, &P::set_id_count);
    io(s.last_sequence, p, &P::last_sequence, &P::set_last_sequence);
    io.text(s.title, p.mutable_title());
    io.text(s.name, p.mutable_name());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<RequestDone> s, proto::RequestDone& p) {
    using P = proto::RequestDone;
    io(s.request, p, &P::request, &P::set_request);
    io(s.accepted, p, &P::accepted, &P::set_accepted);
    io.text(s.text, p.mutable_text());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<CloseScene> s, proto::CloseScene& p) {
    using P = proto::CloseScene;
    io(s.request, p, &P::request, &P::set_request);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<ReadScene> s, proto::ReadScene& p) {
    using P = proto::ReadScene;
    io(s.request, p, &P::request, &P::set_request);
    io.message(s.known, p.mutable_known());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<LockObjects> s, proto::LockObjects& p) {
    using P = proto::LockObjects;
    io(s.request, p, &P::request, &P::set_request);
    io.list(s.objects, p.mutable_objects(), MaxList);
    io(s.release, p, &P::release, &P::set_release);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<SetPresence> s, proto::SetPresence& p) {
    using P = proto::SetPresence;
    io.text(s.text, p.mutable_text());
    io.list(s.selection, p.mutable_selection(), MaxList);
    io(s.time_to_live, p, &P::time_to_live, &P::set_time_to_live);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<ReadPeople> s, proto::ReadPeople& p) {
    using P = proto::ReadPeople;
    io(s.request, p, &P::request, &P::set_request);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<Person> s, proto::Person& p) {
    using P = proto::Person;
    io(s.session, p, &P::session, &P::set_session);
    io.text(s.name, p.mutable_name());
    io.text(s.user, p.mutable_user());
    io.text(s.text, p.mutable_text());
    io.list(s.selection, p.mutable_selection(), MaxList);
    io(s.editor, p, &P::editor, &P::set_editor);
    io(s.clock_offset_seconds, p, &P::clock_offset_seconds, &P::set_clock_offset_seconds);
    io(s.clock_bound_seconds, p, &P::clock_bound_seconds, &P::set_clock_bound_seconds);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<ObjectLock> s, proto::ObjectLock& p) {
    using P = proto::ObjectLock;
    io(s.object, p, &P::object, &P::set_object);
    io.text(s.name, p.mutable_name());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<LiveViewSummary> s, proto::LiveViewSummary& p) {
    using P = proto::LiveViewSummary;
    io.text(s.name, p.mutable_name());
    io.text(s.owner, p.mutable_owner());
    io(s.width, p, &P::width, &P::set_width);
    io(s.height, p, &P::height, &P::set_height);
    io(s.samples, p, &P::samples, &P::set_samples);
    io(s.spp, p, &P::spp, &P::set_spp);
    io(s.watchers, p, &P::watchers, &P::set_watchers);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<People> s, proto::People& p) {
    using P = proto::People;
    io(s.request, p, &P::request, &P::set_request);
    io.text(s.title, p.mutable_title());
    io.messages(s.people, p.mutable_people(), MaxList);
    io.messages(s.locks, p.mutable_locks(), MaxList);
    io.messages(s.views, p.mutable_views(), MaxList);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<ReadHistory> s, proto::ReadHistory& p) {
    using P = proto::ReadHistory;
    io(s.request, p, &P::request, &P::set_request);
    io(s.count, p, &P::count, &P::set_count);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<TransactionSummary> s, proto::TransactionSummary& p) {
    using P = proto::TransactionSummary;
    io(s.number, p, &P::number, &P::set_number);
    io.text(s.name, p.mutable_name());
    io.text(s.user, p.mutable_user());
    io(s.time, p, &P::time, &P::set_time);
    io(s.edits, p, &P::edits, &P::set_edits);
    io.text(s.text, p.mutable_text());
    io(s.undoes, p, &P::undoes, &P::set_undoes);
    io(s.undone_by, p, &P::undone_by, &P::set_undone_by);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<History> s, proto::History& p) {
    using P = proto::History;
    io(s.request, p, &P::request, &P::set_request);
    io.messages(s.transactions, p.mutable_transactions(), MaxList);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<ReadWriters> s, proto::ReadWriters& p) {
    using P = proto::ReadWriters;
    io(s.request, p, &P::request, &P::set_request);
    io(s.object, p, &P::object, &P::set_object);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<FieldWriter> s, proto::FieldWriter& p) {
    using P = proto::FieldWriter;
    io(s.field, p, &P::field, &P::set_field);
    io(s.transaction, p, &P::transaction, &P::set_transaction);
    io.text(s.name, p.mutable_name());
    io.text(s.user, p.mutable_user());
    io(s.time, p, &P::time, &P::set_time);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<Writers> s, proto::Writers& p) {
    using P = proto::Writers;
    io(s.request, p, &P::request, &P::set_request);
    io.messages(s.fields, p.mutable_fields(), MaxList);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<OpenLiveView> s, proto::OpenLiveView& p) {
    using P = proto::OpenLiveView;
    io(s.request, p, &P::request, &P::set_request);
    io(s.number, p, &P::number, &P::set_number);
    io.text(s.name, p.mutable_name());
    io.message(s.view, p.mutable_view());
    io(s.spp, p, &P::spp, &P::set_spp);
    io(s.picture, p, &P::picture, &P::set_picture);
    io(s.film, p, &P::film, &P::set_film);
    io(s.share, p, &P::share, &P::set_share);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<CloseLiveView> s, proto::CloseLiveView& p) {
    using P = proto::CloseLiveView;
    io(s.number, p, &P::number, &P::set_number);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<FrameTaken> s, proto::FrameTaken& p) {
    using P = proto::FrameTaken;
    io(s.number, p, &P::number, &P::set_number);
    io(s.frame, p, &P::frame, &P::set_frame);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<Pick> s, proto::Pick& p) {
    using P = proto::Pick;
    io(s.request, p, &P::request, &P::set_request);
    io(s.number, p, &P::number, &P::set_number);
    io(s.x, p, &P::x, &P::set_x);
    io(s.y, p, &P::y, &P::set_y);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<Picked> s, proto::Picked& p) {
    using P = proto::Picked;
    io(s.request, p, &P::request, &P::set_request);
    io.message(s.version, p.mutable_version());
    io(s.hit, p, &P::hit, &P::set_hit);
    io(s.object, p, &P::object, &P::set_object);
    io.vector(s.position, p.mutable_position());
    io.vector(s.normal, p.mutable_normal());
    io(s.distance, p, &P::distance, &P::set_distance);
    io.text(s.problem, p.mutable_problem());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<ReadTrace> s, proto::ReadTrace& p) {
    using P = proto::ReadTrace;
    io(s.request, p, &P::request, &P::set_request);
    io(s.count, p, &P::count, &P::set_count);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<NodeTrace> s, proto::NodeTrace& p) {
    using P = proto::NodeTrace;
    io.text(s.name, p.mutable_name());
    io(s.received, p, &P::received, &P::set_received);
    io(s.built, p, &P::built, &P::set_built);
    io(s.bound, p, &P::bound, &P::set_bound);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<EditTrace> s, proto::EditTrace& p) {
    using P = proto::EditTrace;
    io(s.transaction, p, &P::transaction, &P::set_transaction);
    io.text(s.name, p.mutable_name());
    io(s.edit_bytes, p, &P::edit_bytes, &P::set_edit_bytes);
    io(s.submitted, p, &P::submitted, &P::set_submitted);
    io(s.bound, p, &P::bound, &P::set_bound);
    io(s.received, p, &P::received, &P::set_received);
    io(s.published, p, &P::published, &P::set_published);
    io.messages(s.nodes, p.mutable_nodes(), MaxList);
    io(s.merged, p, &P::merged, &P::set_merged);
    io.message(s.version, p.mutable_version());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<Trace> s, proto::Trace& p) {
    using P = proto::Trace;
    io(s.request, p, &P::request, &P::set_request);
    io.messages(s.edits, p.mutable_edits(), MaxList);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<StageTimes> s, proto::StageTimes& p) {
    using P = proto::StageTimes;
    io.text(s.name, p.mutable_name());
    io(s.count, p, &P::count, &P::set_count);
    io(s.p50_seconds, p, &P::p50_seconds, &P::set_p50_seconds);
    io(s.p99_seconds, p, &P::p99_seconds, &P::set_p99_seconds);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<LiveStatus> s, proto::LiveStatus& p) {
    using P = proto::LiveStatus;
    io.text(s.title, p.mutable_title());
    io(s.members, p, &P::members, &P::set_members);
    io(s.views, p, &P::views, &P::set_views);
    io(s.edits, p, &P::edits, &P::set_edits);
    io(s.transactions, p, &P::transactions, &P::set_transactions);
    io(s.edit_bytes, p, &P::edit_bytes, &P::set_edit_bytes);
    io(s.versions, p, &P::versions, &P::set_versions);
    io(s.change_bytes, p, &P::change_bytes, &P::set_change_bytes);
    io(s.journal_bytes, p, &P::journal_bytes, &P::set_journal_bytes);
    io(s.checkpoints, p, &P::checkpoints, &P::set_checkpoints);
    io.messages(s.stages, p.mutable_stages(), MaxList);
}

}  // namespace tessera::wire
