#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "master/display/display_service.h"
#include "master/kept_jobs.h"
#include "master/peers/node_table.h"
#include "master/peers/session_table.h"
#include "master/render/views.h"
#include "master/scene/edit_trace.h"
#include "master/scene/scene_authority.h"
#include "master/scene/scene_distributor.h"
#include "master/scene/session_journal.h"

namespace tessera::master {

// What a scene session shares with all others of its master.
struct MasterServices {
    std::shared_ptr<scene::BlobStore> blobs;
    NodeTable& nodes;
    SessionTable& sessions;
    Outbox& outbox;
    RenderServices render;
    KeptJobs& jobs;
    EventSink events;
};

// All that belongs to one scene: its content and history, the nodes' copies, its views, its display, its files
// on disk, who is in it and what they ask, and when their edits become a version. Told of messages by the
// render master; what happens below comes up as values that are taken in tick().
//
// Edits are taken and answered at once. A version is published at once when no first picture is on its way
// and the last version is 16 ms old, else as soon as both are so.
class SceneSession {
  public:
    SceneSession(std::uint64_t epoch, const ViewSettings& settings, const MasterServices& services);

    // From now on edits are recorded in the folder. What it recovers is open again. Throws Error when it cannot
    // be used.
    void record_to(const std::filesystem::path& folder, Duration checkpoint_interval, TimePoint now);

    SceneAuthority& authority() { return authority_; }
    const SceneAuthority& authority() const { return authority_; }
    SceneDistributor& distributor() { return distributor_; }
    const SceneDistributor& distributor() const { return distributor_; }
    Views& views() { return views_; }
    const Views& views() const { return views_; }
    DisplayService& display() { return display_; }
    const DisplayService& display() const { return display_; }

    bool is_open() const { return open_; }
    bool is_member(SessionId session) const { return members_.contains(session); }
    const std::string& name(SessionId session) const { return members_.at(session).name; }
    std::size_t member_count() const { return members_.size(); }
    const std::string& title() const { return scene_.title; }

    bool is_exclusive() const { return scene_.owner.has_value(); }
    // Whether it would be let in at once: to the open scene, that is.
    bool admits(const SessionRecord& session, const wire::JoinScene& request) const;
    // Opens a scene where none is open. Throws Error when the session cannot be let in.
    void join(SessionRecord& session, const wire::JoinScene& request, TimePoint now);
    // Everybody is out, and the scene is empty.
    void close(TimePoint now);
    // A member has gone; an exclusive scene goes with it.
    void left(SessionId session, Views::Departure departure, TimePoint now);

    // To the nodes and everything that looks at the scene.
    void publish(const scene::ChangeList& changes, TimePoint now);
    // A member's edit was answered.
    void edited(const SessionRecord& session, const scene::Edit& edit, const EditAnswer& answer,
                std::uint64_t message_bytes, TimePoint now);
    void node_built(const NodeRecord& node, const wire::VersionReport& report, TimePoint now);
    void node_gone(NodeId node) { traces_.node_gone(node); }

    void asked(SessionRecord& session, const wire::ReadScene& request);
    void asked(SessionRecord& session, const wire::LockObjects& request);
    void asked(SessionRecord& session, wire::SetPresence request, TimePoint now);
    void asked(SessionRecord& session, const wire::ReadPeople& request, TimePoint now);
    void asked(SessionRecord& session, const wire::ReadHistory& request);
    void asked(SessionRecord& session, const wire::ReadWriters& request);
    void asked(SessionRecord& session, wire::RequestView request, TimePoint now);
    void asked(SessionRecord& session, const wire::SetViewFilter& request, TimePoint now);

    // Jobs of the scene, and those that have ended, of any scene; for any client.
    void asked(SessionRecord& session, const wire::ReadJobs& request);
    void asked(SessionRecord& session, const wire::FetchJob& request);
    void asked(SessionRecord& session, const wire::CancelJob& request);

    // "" or what is wrong.
    std::string open_display(const scene::BlobPtr& description, std::vector<scene::BlobPtr> content,
                             TimePoint now);
    void asked(SessionRecord& session, const wire::CloseDisplay& request);
    void asked(SessionRecord& session, const wire::AdjustDisplay& request);
    void asked(SessionRecord& session, const wire::JoinOutput& request, TimePoint now);

    net::Bytes trace(const wire::ReadTrace& request) const;  // the encoded answer, with as many as fit

    // What the rendering threads brought forth; what is another scene's is left alone.
    void take(RenderOutput& output, TimePoint now);
    void tick(TimePoint now);
    TimePoint next_event(TimePoint now) const;
    session::SceneStatus status() const;

  private:
    struct Member {
        std::string name;
        std::uint64_t key = 0;
        wire::SetPresence presence;
        TimePoint presence_until{};
        scene::BlobPtr content;  // the scene as it was read last: kept until the client has it
    };
    struct LatestContent {
        Version from, to;
        std::weak_ptr<const scene::Blob> blob;  // an encoded change list; members keep it
    };
    struct WaitingRead {
        SessionId session;
        wire::ReadScene request;
        Version wanted;  // that has all edits made before the question
    };

    void open(wire::RecordedTitle scene);
    std::string unique_name(const std::string& wanted) const;
    void answer(const WaitingRead& read);
    scene::BlobPtr encoded(const scene::ChangeList& list);
    void done(const SessionRecord& session, std::uint64_t request, std::string problem);
    void follow_display(TimePoint now);
    void publish_if_due(TimePoint now);
    void keep_journal(TimePoint now);
    std::string open_view(const SessionRecord& session, std::uint64_t number,
                          const session::ViewRequest& wanted, TimePoint now);
    std::string submission_problem(const SessionRecord& session, const session::ViewRequest& wanted) const;
    void record_job(const std::string& name);
    void add_new_jobs(std::vector<wire::SavedView>& saved) const;
    void keep_ended_jobs();
    void close_when_left(TimePoint now);
    const ViewState* job_view(const session::JobName& job) const;

    MasterServices services_;
    Duration owner_patience_;
    SceneAuthority authority_;
    SceneDistributor distributor_;
    Views views_;
    DisplayService display_;
    std::optional<SessionJournal> journal_;
    bool open_ = false;
    wire::RecordedTitle scene_;
    std::optional<TimePoint> left_alone_;  // an exclusive scene of a master before: its owner is waited for
    std::map<SessionId, Member> members_;
    LatestContent latest_content_;
    std::vector<WaitingRead> reads_;
    TimePoint published_at_{};
    std::uint64_t progress_being_saved_ = 0;
    session::SceneStatus counts_;
    EditTraceLog traces_;
};

}  // namespace tessera::master
