#include "master/session_service.h"

#include <algorithm>
#include <functional>

#include "mediator/wire/display_codec.h"
#include "mediator/wire/envelope.h"

namespace tessera::master {

namespace {

// As many texts as an answer can hold.
std::vector<std::string> listed(std::vector<std::string> texts) {
    constexpr std::size_t MaxTexts = 64, MaxLength = 400;
    const std::size_t all = texts.size();
    texts.resize(std::min(all, MaxTexts));
    for (std::string& text : texts) text.resize(std::min(text.size(), MaxLength));
    if (all > MaxTexts) texts.push_back("and " + std::to_string(all - MaxTexts) + " more");
    return texts;
}

std::string edit_of(const wire::EditSize& size) {
    return "an edit of " + std::to_string(size.entries) + " entries";
}

constexpr std::size_t MaxPendingEdits = 256;
}  // namespace

std::string SessionService::busy_text() const {
    if (scene_.is_open() && !scene_.is_exclusive()) {
        return "the cluster is busy with the live scene '" + scene_.title() +
               "': wait in the queue without --no-wait, or close that scene with: tessera edit -c close";
    }
    return "the cluster is rendering another scene: try again later, or wait in the queue without --no-wait";
}

void SessionService::join_scene(SessionRecord& session, const wire::JoinScene& request, TimePoint now) {
    const bool is_free = !scene_.is_open() && sessions_.queue().empty();
    if (is_free || scene_.admits(session, request)) return admit(session, request, now);
    if (scene_.is_member(session.id)) {
        outbox_.control(session.control,
                        wire::Refusal{"this client has joined a scene of another kind: reconnect first"});
        return;
    }
    if (request.no_wait) {
        outbox_.control(session.control, wire::Refusal{busy_text()});
        return;
    }
    session.joining = request;
    session.reported_position = 0;
    sessions_.enqueue(session.id);
    tick(now);
}

void SessionService::admit(SessionRecord& session, const wire::JoinScene& request, TimePoint now) {
    try {
        scene_.join(session, request, now);
    } catch (const Error& error) {
        outbox_.control(session.control, wire::Refusal{error.what()});
    }
}

void SessionService::close_scene(SessionRecord& session, const wire::CloseScene& request, TimePoint now) {
    if (!scene_.is_member(session.id)) return;
    scene_.close(now);
    outbox_.control(session.control, wire::RequestDone{request.request, true, {}});
    tick(now);
}

void SessionService::submit(SessionRecord& session, scene::Edit edit, std::uint64_t message_bytes,
                            TimePoint now) {
    edit.session = session.id;  // overrides the message's value
    if (session.edits.size() >= MaxPendingEdits) {
        return refuse_edit(session, edit.sequence,
                           "too many edits wait for their blobs: send the blobs first");
    }
    if (!session.edits.empty()) {  // it has to wait
        const wire::EditSize size{edit.entries.size(), edit.entries.size() * sizeof(scene::Entry)};
        if (std::string problem = memory_with_edits().problem(size.bytes, edit_of(size));
            !problem.empty()) {  // its turn to be answered will come
            edit = {.session = session.id, .sequence = edit.sequence, .entries = {}};
            return session.edits.push_back({.edit = std::move(edit), .refusal = std::move(problem)});
        }
    }
    session.edits.push_back({.edit = std::move(edit), .bytes = message_bytes});
    advance(session, now);
}

void SessionService::submit(SessionRecord& session, const wire::SubmitEditByBlob& message, TimePoint now) {
    if (session.edits.size() >= MaxPendingEdits) {
        return refuse_edit(session, message.sequence,
                           "too many edits wait for their blobs: send the blobs first");
    }
    scene::Edit placeholder{
        .session = session.id, .sequence = message.sequence, .base = message.base, .entries = {}};
    session.edits.push_back({.encoded = message.blob, .edit = std::move(placeholder)});
    advance(session, now);
}

MemoryUse SessionService::memory_with_edits() const {
    MemoryUse memory = scene_.memory();
    for (const auto& [id, session] : sessions_.all()) {
        for (const SessionRecord::PendingEdit& pending : session.edits)
            memory.used += pending.edit.entries.size() * sizeof(scene::Entry);
    }
    return memory;
}

void SessionService::refuse_edit(SessionRecord& session, std::uint64_t sequence, std::string problem) {
    // Not while an edit is applied: then it is one too many.
    const bool is_next = session.edits.empty() || session.edits.front().edit.sequence == sequence;
    if (is_next && !scene_.is_editing()) scene_.refused(session.id, sequence, problem);
    outbox_.control(session.control, wire::EditReply{.sequence = sequence,
                                                     .result = {.accepted = false,
                                                                .version = scene_.published().version(),
                                                                .problems = listed({std::move(problem)})}});
}

void SessionService::want(SessionRecord& session, const scene::BlobRef& blob, const std::string& what) {
    if (session.fetcher.wants(blob.hash)) {  // counted already; an absent one is asked for again
        (void)session.fetcher.want(blob);
        return;
    }
    std::uint64_t bytes = scene_.collector().held_bytes(session.user);
    for (const auto& [id, other] : sessions_.all()) {
        if (other.user == session.user) bytes += other.fetcher.wanted_bytes();
    }
    if (bytes + blob.byte_size > quota_) {
        throw Error(ErrorCode::Refused,
                    "the meshes, textures and films of this key would take " +
                        std::to_string((bytes + blob.byte_size) >> 20) + " MiB, more than its quota of " +
                        std::to_string(quota_ >> 20) +
                        ": remove some from the scene, or raise --blob-quota of the master");
    }
    if (std::string problem = scene_.memory_problem(blob.byte_size, what); !problem.empty())
        throw Error(ErrorCode::Refused, problem);
    if (auto wanted = session.fetcher.want(blob); !wanted) throw wanted.error();
}

void SessionService::request_blobs(SessionRecord& session, TimePoint now) {
    if (!session.bulk) return;
    for (const wire::BlobRequest& request : session.fetcher.due(now)) outbox_.bulk(*session.bulk, request);
}

// An edit on its way through the authority; long ones are decoded there, too.
struct SessionService::RunningEdit {
    SessionId session;
    SessionRecord::PendingEdit pending;
    scene::BlobPtr encoded;
    Editor who;
    MemoryUse memory;
    std::vector<scene::BlobRef> missing;  // wanted before it can be applied
    EditAnswer answer;
    std::string problem;

    void run(SceneAuthority& authority) {
        try {
            if (encoded) decode();
            missing = authority.missing_blobs(pending.edit);
            if (missing.empty()) answer = authority.submit(pending.edit, who);
        } catch (const std::bad_alloc&) {
            problem = "the master has no memory for this edit: split it";
        } catch (const std::exception& error) {
            problem = error.what();
        }
    }

  private:
    void decode() {
        const wire::EditSize size = wire::measure_edit(encoded->bytes());
        if (const std::string too_large = memory.problem(size.bytes, edit_of(size)); !too_large.empty())
            throw Error(ErrorCode::Refused, too_large);
        auto decoded = wire::decode_edit(encoded->bytes());
        if (!decoded) throw decoded.error();
        decoded->session = pending.edit.session;  // overrides the blob's value
        decoded->sequence = pending.edit.sequence;
        pending.edit = std::move(*decoded);
        pending.bytes += encoded->bytes().size();
        pending.encoded.reset();
        encoded.reset();
    }
};

void SessionService::advance(SessionRecord& session, TimePoint now) {
    bool waits = false;
    while (!session.edits.empty() && !session.edit_runs) {
        SessionRecord::PendingEdit& pending = session.edits.front();
        waits = scene_.is_editing();
        try {
            if (!scene_.is_member(session.id))
                throw Error(ErrorCode::Refused, "this session has no open scene: open one first");
            if (!pending.refusal.empty()) throw Error(ErrorCode::Refused, pending.refusal);
            if (pending.encoded && !blobs_->find(pending.encoded->hash)) {
                want(session, *pending.encoded);
                waits = false;
                break;
            }
        } catch (const Error& error) {
            if (waits) break;  // the authority has to know of it
            refuse_edit(session, pending.edit.sequence, error.what());
            session.edits.pop_front();
            continue;
        }
        if (waits) break;
        const std::size_t before = session.edits.size();
        apply_first(session, now);
        if (!session.edit_runs && session.edits.size() == before) break;  // it waits for blobs
    }
    session.edits_wait = waits || session.edit_runs;
    if (session.opening && !session.edit_runs) advance_display(session, now);
    if (session.continuing && !session.edit_runs) advance_view(session, now);
    if (session.edits.empty() && !session.opening && !session.continuing) session.fetcher.release_completed();
    request_blobs(session, now);
}

void SessionService::apply_first(SessionRecord& session, TimePoint now) {
    const auto edit = std::make_shared<RunningEdit>();
    SessionRecord::PendingEdit& pending = session.edits.front();
    const std::size_t encoded_bytes = pending.encoded ? pending.encoded->byte_size : 0;
    edit->session = session.id;
    if (pending.encoded) edit->encoded = blobs_->find(pending.encoded->hash);
    edit->memory = memory_with_edits();
    edit->pending = std::move(pending);
    pending.edit.sequence = edit->pending.edit.sequence;
    edit->who = {scene_.name(session.id), session.user, since_1970()};
    last_served_ = session.id;
    session.edit_runs = session.edits_wait = true;
    SceneSession::Cost cost = scene_.cost_of(edit->pending.edit);
    cost.objects += encoded_bytes;  // at least a byte each
    scene_.run(
        cost, [edit](SceneAuthority& authority) { edit->run(authority); },
        [this, edit](TimePoint at) {
            applied(*edit, at);
            if (edit->pending.edit.entries.size() > SceneEncoder::ShortList) scene_.discard(edit);
        },
        now);
}

void SessionService::applied(RunningEdit& edit, TimePoint now) {
    SessionRecord* session = sessions_.find(edit.session);
    if (session == nullptr) return;  // it has left; what was accepted stays
    session->edit_runs = session->edits_wait = false;
    const std::uint64_t sequence = edit.pending.edit.sequence;
    if (edit.problem.empty() && !edit.missing.empty()) {
        try {
            for (const scene::BlobRef& blob : edit.missing) want(*session, blob);
            session->edits.front() = std::move(edit.pending);  // tried again when they are here
            return request_blobs(*session, now);
        } catch (const Error& error) {
            edit.problem = error.what();
        }
    }
    session->edits_wait = true;  // what comes after it: see advance_waiting()
    if (!edit.problem.empty()) {
        refuse_edit(*session, sequence, edit.problem);
        return session->edits.pop_front();
    }
    session->edits.pop_front();
    // A scene that was closed meanwhile has no member to name.
    if (scene_.is_member(session->id))
        scene_.edited(*session, edit.pending.edit, edit.answer, edit.pending.bytes, now);
    outbox_.control(session->control, wire::EditReply{.sequence = sequence,
                                                      .result = {.accepted = edit.answer.accepted,
                                                                 .version = edit.answer.version,
                                                                 .problems = listed(edit.answer.problems),
                                                                 .transaction = edit.answer.transaction,
                                                                 .notes = listed(edit.answer.notes)}});
}

// Sessions take turns, so that one with many long edits does not keep the others waiting.
void SessionService::advance_waiting(TimePoint now) {
    std::vector<SessionId> waiting;
    for (const auto& [id, session] : sessions_.all()) {
        if (session.edits_wait && !session.edit_runs) waiting.push_back(id);
    }
    std::ranges::rotate(waiting, std::ranges::upper_bound(waiting, last_served_));
    for (const SessionId id : waiting) {
        if (scene_.is_editing()) return;
        if (SessionRecord* session = sessions_.find(id)) advance(*session, now);
    }
}

void SessionService::open_display(SessionRecord& session, const wire::OpenDisplay& request, TimePoint now) {
    session.opening = request;
    advance(session, now);
}

void SessionService::advance_display(SessionRecord& session, TimePoint now) {
    std::string problem;
    try {
        const auto here = [&](const scene::BlobRef& blob) {
            scene::BlobPtr found = blobs_->find(blob.hash);
            if (found) return found;
            want(session, blob);
            return found;
        };
        const scene::BlobPtr description = here(session.opening->description);
        if (!description) return;
        const auto display = wire::decode_display(description->bytes());
        if (!display) throw display.error();
        std::vector<scene::BlobPtr> content;
        bool complete = true;
        for (const display::Output& output : display->outputs) {
            for (const display::Grid& grid : {output.points, output.blend.weights, output.blend.lift}) {
                if (grid.empty()) continue;
                content.push_back(here(grid.values));
                complete = complete && content.back() != nullptr;
            }
        }
        if (!complete) return;
        problem = scene_.open_display(description, std::move(content), now);
    } catch (const Error& error) {
        problem = error.what();
    }
    const wire::OpenDisplay request = *std::exchange(session.opening, std::nullopt);
    const bool accepted = problem.empty();
    outbox_.control(session.control, wire::RequestDone{request.request, accepted, std::move(problem)});
}

void SessionService::chunk(SessionRecord& session, wire::BlobChunk&& chunk, TimePoint now) {
    outbox_.bytes.blobs += chunk.data.size();
    // A wrong chunk is requested again; a session that keeps sending them only delays itself.
    const scene::BlobRef blob{chunk.hash, chunk.total};
    const std::uint64_t wanted = session.fetcher.wanted_bytes();
    (void)session.fetcher.receive(std::move(chunk), now);
    if (session.fetcher.wanted_bytes() < wanted) scene_.collector().received(session.user, blob);
    // An edit of 100,000 objects is not looked through again for each of its blobs.
    if (session.fetcher.idle() && !session.edit_runs) return advance(session, now);
    request_blobs(session, now);
}

void SessionService::absent(SessionRecord& session, const wire::BlobAbsent& absent, TimePoint now) {
    session.fetcher.absent(absent.hash);
    if (session.edits.empty() && session.opening) {
        const wire::OpenDisplay request = *std::exchange(session.opening, std::nullopt);
        session.fetcher.forget_all();
        return outbox_.control(session.control,
                               wire::RequestDone{request.request, false,
                                                 "the client does not have blob " + to_hex(absent.hash) +
                                                     " that its display refers to"});
    }
    if (session.edits.empty() && session.continuing) {
        session.fetcher.forget_all();
        return refuse_view(session, "the client does not have blob " + to_hex(absent.hash) +
                                        " with the view's earlier film");
    }
    if (session.edits.empty() || session.edit_runs) return;
    refuse_edit(session, session.edits.front().edit.sequence,
                "the client does not have blob " + to_hex(absent.hash) + " that its edit refers to");
    session.edits.pop_front();
    session.fetcher.forget_all();
    advance(session, now);
}

void SessionService::closed(SessionId id, Views::DisconnectReason reason, TimePoint now) {
    scene_.left(id, reason, now);
    sessions_.remove(id);
    tick(now);
}

void SessionService::tick(TimePoint now) {
    advance_waiting(now);
    const auto admit_from_queue = [&](SessionId id) {
        SessionRecord& session = *sessions_.find(id);
        sessions_.leave_queue(id);
        const wire::JoinScene request = *std::exchange(session.joining, std::nullopt);
        admit(session, request, now);
    };
    while (!scene_.is_open() && !scene_.is_editing() && !sessions_.queue().empty())
        admit_from_queue(sessions_.queue().front());
    // A client that would join a live scene does not wait for those ahead that want an exclusive scene.
    const std::deque<SessionId> waiting = sessions_.queue();
    for (const SessionId id : waiting) {
        const SessionRecord& session = *sessions_.find(id);
        if (!scene_.is_editing() && scene_.admits(session, *session.joining)) admit_from_queue(id);
    }
    for (const SessionId id : sessions_.queue()) {
        SessionRecord& session = *sessions_.find(id);
        const std::uint32_t place = sessions_.queue_position(id);
        if (place == session.reported_position) continue;
        session.reported_position = place;
        outbox_.control(session.control, wire::SceneJoined{.version = {}, .queue_position = place});
    }
    for (auto& [id, session] : sessions_.all()) {
        if (session.continuing && !session.edit_runs) advance_view(session, now);  // it may wait for an edit
        if (!session.fetcher.idle()) request_blobs(session, now);
    }
}

}  // namespace tessera::master
