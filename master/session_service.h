#pragma once

#include "master/peers/session_table.h"
#include "master/scene_session.h"
#include "mediator/wire/envelope.h"

namespace tessera::master {

// Serves clients: the queue for the scene, edits and their blobs. RenderMaster passes messages to it.
class SessionService {
  public:
    // `quota`: bytes of blobs that the clients of a key may have the master hold.
    SessionService(std::shared_ptr<scene::BlobStore> blobs, std::uint64_t quota, SessionTable& sessions,
                   SceneSession& scene, Outbox& outbox)
        : blobs_(std::move(blobs)), quota_(quota), sessions_(sessions), scene_(scene), outbox_(outbox) {}

    void join_scene(SessionRecord& session, const wire::JoinScene& request, TimePoint now);
    void close_scene(SessionRecord& session, const wire::CloseScene& request, TimePoint now);
    void submit(SessionRecord& session, scene::Edit edit, std::uint64_t message_bytes, TimePoint now);
    void submit(SessionRecord& session, const wire::SubmitEditByBlob& edit, TimePoint now);
    void open_display(SessionRecord& session, const wire::OpenDisplay& request, TimePoint now);
    // Opens it once the film that it continues is here.
    void request_view(SessionRecord& session, const wire::RequestView& request, TimePoint now);
    void end_view(SessionRecord& session, const wire::EndView& request, TimePoint now);
    void chunk(SessionRecord& session, wire::BlobChunk&& chunk, TimePoint now);
    void absent(SessionRecord& session, const wire::BlobAbsent& absent, TimePoint now);
    // The session is no longer a member of the scene.
    void closed(SessionId session, Views::DisconnectReason reason, TimePoint now);

    void tick(TimePoint now);  // admits queued clients, requests chunks

  private:
    struct RunningEdit;
    void advance(SessionRecord& session, TimePoint now);  // applies edits whose blobs have arrived
    void apply_first(SessionRecord& session, TimePoint now);
    void applied(RunningEdit& edit, TimePoint now);
    void advance_waiting(TimePoint now);
    // Throws Error over a limit.
    void want(SessionRecord& session, const scene::BlobRef& blob,
              const std::string& what = "a mesh or texture");
    void request_blobs(SessionRecord& session, TimePoint now);
    void advance_display(SessionRecord& session, TimePoint now);
    void advance_view(SessionRecord& session, TimePoint now);
    void film_decoded(SessionId session, const scene::BlobRef& blob, Expected<frame::FilmState>&& film,
                      TimePoint now);
    void refuse_view(SessionRecord& session, std::string problem);
    MemoryUse memory_with_edits() const;  // those that wait included
    void refuse_edit(SessionRecord& session, std::uint64_t sequence, std::string problem);
    void admit(SessionRecord& session, const wire::JoinScene& request, TimePoint now);
    std::string busy_text() const;

    std::shared_ptr<scene::BlobStore> blobs_;
    std::uint64_t quota_;
    SessionTable& sessions_;
    SceneSession& scene_;
    Outbox& outbox_;
    SessionId last_served_;  // whose edit was started last
};

}  // namespace tessera::master
