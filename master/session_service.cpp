#include "master/session_service.h"

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
        if (std::string problem = edit_problem(size);
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

std::string SessionService::edit_problem(const wire::EditSize& size) const {
    std::uint64_t waiting = 0;
    for (const auto& [id, session] : sessions_.all()) {
        for (const SessionRecord::PendingEdit& pending : session.edits)
            waiting += pending.edit.entries.size();
    }
    return scene_.memory_problem(size.bytes + waiting * sizeof(scene::Entry),
                                 "an edit of " + std::to_string(size.entries) + " entries");
}

void SessionService::refuse_edit(SessionRecord& session, std::uint64_t sequence, std::string problem) {
    const bool is_next = session.edits.empty() || session.edits.front().edit.sequence == sequence;
    if (is_next) scene_.authority().refused(session.id, sequence, problem);
    outbox_.control(session.control, wire::EditReply{.sequence = sequence,
                                                     .result = {.accepted = false,
                                                                .version = scene_.authority().version(),
                                                                .problems = listed({std::move(problem)})}});
}

void SessionService::want(SessionRecord& session, const scene::BlobRef& blob) {
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
                    "the meshes and textures of this key would take " +
                        std::to_string((bytes + blob.byte_size) >> 20) + " MiB, more than its quota of " +
                        std::to_string(quota_ >> 20) +
                        ": remove some from the scene, or raise --blob-quota of the master");
    }
    if (std::string problem = scene_.memory_problem(blob.byte_size, "a mesh or texture"); !problem.empty())
        throw Error(ErrorCode::Refused, problem);
    if (auto wanted = session.fetcher.want(blob); !wanted) throw wanted.error();
}

void SessionService::request_blobs(SessionRecord& session, TimePoint now) {
    if (!session.bulk) return;
    for (const wire::BlobRequest& request : session.fetcher.due(now)) outbox_.bulk(*session.bulk, request);
}

bool SessionService::blobs_are_here(SessionRecord& session, SessionRecord::PendingEdit& pending) {
    if (pending.encoded) {
        const scene::BlobPtr blob = blobs_->find(pending.encoded->hash);
        if (!blob) {
            want(session, *pending.encoded);
            return false;
        }
        if (std::string problem = edit_problem(wire::measure_edit(blob->bytes())); !problem.empty())
            throw Error(ErrorCode::Refused, problem);
        auto decoded = wire::decode_edit(blob->bytes());
        if (!decoded) throw decoded.error();
        decoded->session = pending.edit.session;  // overrides the blob's value
        decoded->sequence = pending.edit.sequence;
        pending.edit = std::move(*decoded);
        pending.bytes += blob->bytes().size();
        pending.encoded.reset();
    }
    const std::vector<scene::BlobRef> missing = scene_.authority().missing_blobs(pending.edit);
    for (const scene::BlobRef& blob : missing) want(session, blob);
    return missing.empty();
}

void SessionService::advance(SessionRecord& session, TimePoint now) {
    while (!session.edits.empty()) {
        SessionRecord::PendingEdit& pending = session.edits.front();
        if (!scene_.is_member(session.id)) {
            refuse_edit(session, pending.edit.sequence, "this session has no open scene: open one first");
            session.edits.pop_front();
            continue;
        }
        try {
            if (!pending.refusal.empty()) throw Error(ErrorCode::Refused, pending.refusal);
            if (!blobs_are_here(session, pending)) break;
        } catch (const Error& error) {
            refuse_edit(session, pending.edit.sequence, error.what());
            session.edits.pop_front();
            continue;
        }
        const EditAnswer answer =
            scene_.authority().submit(pending.edit, {scene_.name(session.id), session.user, since_1970()});
        scene_.edited(session, pending.edit, answer, pending.bytes, now);
        outbox_.control(session.control, wire::EditReply{.sequence = pending.edit.sequence,
                                                         .result = {.accepted = answer.accepted,
                                                                    .version = answer.version,
                                                                    .problems = listed(answer.problems),
                                                                    .transaction = answer.transaction,
                                                                    .notes = listed(answer.notes)}});
        session.edits.pop_front();
    }
    if (session.opening) advance_display(session, now);
    if (session.edits.empty() && !session.opening) session.fetcher.release_completed();
    request_blobs(session, now);
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
    if (session.fetcher.idle()) return advance(session, now);
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
    if (session.edits.empty()) return;
    refuse_edit(session, session.edits.front().edit.sequence,
                "the client does not have blob " + to_hex(absent.hash) + " that its edit refers to");
    session.edits.pop_front();
    session.fetcher.forget_all();
    advance(session, now);
}

void SessionService::closed(SessionId id, Views::DisconnectReason reason, TimePoint now) {
    scene_.left(id, reason, now);
    sessions_.remove(id);
    scene_.authority().forget(id);
    tick(now);
}

void SessionService::tick(TimePoint now) {
    const auto admit_from_queue = [&](SessionId id) {
        SessionRecord& session = *sessions_.find(id);
        sessions_.leave_queue(id);
        const wire::JoinScene request = *std::exchange(session.joining, std::nullopt);
        admit(session, request, now);
    };
    while (!scene_.is_open() && !sessions_.queue().empty()) admit_from_queue(sessions_.queue().front());
    // A client that would join a live scene does not wait for those ahead that want an exclusive scene.
    const std::deque<SessionId> waiting = sessions_.queue();
    for (const SessionId id : waiting) {
        const SessionRecord& session = *sessions_.find(id);
        if (scene_.admits(session, *session.joining)) admit_from_queue(id);
    }
    for (const SessionId id : sessions_.queue()) {
        SessionRecord& session = *sessions_.find(id);
        const std::uint32_t place = sessions_.queue_position(id);
        if (place == session.reported_position) continue;
        session.reported_position = place;
        outbox_.control(session.control, wire::SceneJoined{.version = {}, .queue_position = place});
    }
    for (auto& [id, session] : sessions_.all()) {
        if (!session.fetcher.idle()) request_blobs(session, now);
    }
}

}  // namespace tessera::master
