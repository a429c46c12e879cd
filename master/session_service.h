#pragma once

#include <functional>

#include "master/live_service.h"
#include "master/peers/session_table.h"
#include "master/render/job_runner.h"
#include "master/scene/scene_authority.h"

namespace tessera::master {

// Serves clients: the stage, edits with their blobs, jobs. Told of messages by the render master.
class SessionService {
  public:
    // `publish` hands a change list to all nodes.
    SessionService(SceneAuthority& authority, std::shared_ptr<scene::BlobStore> blobs, SessionTable& sessions,
                   JobRunner& jobs, LiveService& live, Outbox& outbox,
                   std::function<void(const scene::ChangeList&, TimePoint)> publish);

    void open_scene(SessionRecord& session, const wire::OpenScene& request, TimePoint now);
    void join_scene(SessionRecord& session, const wire::JoinScene& request, TimePoint now);
    void close_live_scene(SessionRecord& session, const wire::CloseScene& request, TimePoint now);
    void submit(SessionRecord& session, scene::Edit edit, std::uint64_t message_bytes, TimePoint now);
    void submit(SessionRecord& session, const wire::SubmitEditByBlob& edit, TimePoint now);
    void open_display(SessionRecord& session, const wire::OpenDisplay& request, TimePoint now);
    void chunk(SessionRecord& session, wire::BlobChunk&& chunk, TimePoint now);
    void absent(SessionRecord& session, const wire::BlobAbsent& absent, TimePoint now);
    void start_job(SessionRecord& session, wire::StartJob request, TimePoint now);
    // Its batch scene and job go; of a live scene it is no longer a member.
    void closed(SessionId session, LiveRunner::Departure departure, TimePoint now);

    void tick(TimePoint now);  // who is next on the stage, chunks to ask for

  private:
    void advance(SessionRecord& session, TimePoint now);  // edits whose blobs are here
    bool blobs_are_here(SessionRecord& session, SessionRecord::PendingEdit& edit);
    void advance_display(SessionRecord& session, TimePoint now);
    void refuse_edit(SessionRecord& session, std::string problem);
    void give_stage(SessionId session);
    void let_in(SessionRecord& session, const wire::JoinScene& request, TimePoint now);
    std::string busy_text() const;

    SceneAuthority& authority_;
    std::shared_ptr<scene::BlobStore> blobs_;
    SessionTable& sessions_;
    JobRunner& jobs_;
    LiveService& live_;
    Outbox& outbox_;
    std::function<void(const scene::ChangeList&, TimePoint)> publish_;
};

}  // namespace tessera::master
