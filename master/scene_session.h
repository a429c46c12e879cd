#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "master/display/display_service.h"
#include "master/job_store.h"
#include "master/peers/node_table.h"
#include "master/peers/session_table.h"
#include "master/render/views.h"
#include "master/scene/blob_collector.h"
#include "master/scene/edit_trace.h"
#include "master/scene/scene_authority.h"
#include "master/scene/scene_distributor.h"
#include "master/scene/scene_reads.h"
#include "master/scene/session_journal.h"

namespace tessera::master {

// Services of the master that a scene session uses.
struct MasterServices {
    std::shared_ptr<scene::BlobStore> blobs;
    NodeTable& nodes;
    SessionTable& sessions;
    Outbox& outbox;
    RenderServices render;
    JobStore& jobs;
    EventSink events;
    Duration collect_interval;       // of unused blobs; see blob_collector.h
    std::uint64_t memory_limit = 0;  // 0: three quarters of the machine's memory
};

// Everything that belongs to one scene: content, edit history, replicas on nodes, views, display, files on disk,
// members and their requests. RenderMaster passes messages to it; results of the rendering threads are taken
// in tick().
//
// Edits are applied and answered immediately. A version is published as soon as no first picture is pending and
// the last version is at least 16 ms old.
class SceneSession {
  public:
    SceneSession(std::uint64_t epoch, const ViewSettings& settings, const MasterServices& services);

    // Records edits in the folder from now on, after reopening the session stored there. Throws Error if the
    // folder cannot be used.
    void record_to(const std::filesystem::path& folder, Duration checkpoint_interval, TimePoint now);

    SceneAuthority& authority() { return authority_; }
    const SceneAuthority& authority() const { return authority_; }
    SceneDistributor& distributor() { return distributor_; }
    const SceneDistributor& distributor() const { return distributor_; }
    // Why the master has no room for so many more bytes of `what`; "" = it has. `replaced`: a view that goes for it.
    std::string memory_problem(std::uint64_t bytes, const std::string& what,
                               std::optional<ViewId> replaced = std::nullopt) const;
    BlobCollector& collector() { return collector_; }
    Views& views() { return views_; }
    const Views& views() const { return views_; }
    DisplayService& display() { return display_; }
    const DisplayService& display() const { return display_; }

    // Blobs of the scene are for editors and nodes. A viewer may fetch what it was sent, and those of the display.
    bool may_fetch(const SessionRecord& session, const Hash256& blob) const;

    bool is_open() const { return open_; }
    bool is_member(SessionId session) const { return members_.contains(session); }
    const std::string& name(SessionId session) const { return members_.at(session).name; }
    std::size_t member_count() const { return members_.size(); }
    const std::string& title() const { return scene_.title; }

    bool is_exclusive() const { return scene_.owner.has_value(); }
    // Whether the session could join the open scene immediately.
    bool admits(const SessionRecord& session, const wire::JoinScene& request) const;
    // Opens a scene if none is open. Throws Error if the session may not join.
    void join(SessionRecord& session, const wire::JoinScene& request, TimePoint now);
    // Removes all members and empties the scene.
    void close(TimePoint now);
    // A member has left; an exclusive scene is closed.
    void left(SessionId session, Views::DisconnectReason reason, TimePoint now);

    // Distributes the changes to nodes, views and display.
    void publish(scene::ChangeList&& changes, TimePoint now);
    // Called when a member's edit was answered.
    void edited(const SessionRecord& session, const scene::Edit& edit, const EditAnswer& answer,
                std::uint64_t message_bytes, TimePoint now);
    void node_built(const NodeRecord& node, const wire::VersionReport& report, TimePoint now);
    void node_gone(NodeId node) { traces_.node_gone(node); }
    // A node cannot build the version. If none can, the edits since the last version that one built are undone, and
    // their authors get the reason. An exclusive scene stays as it is: its views end with the reason.
    void node_refused(NodeRecord& node, const wire::SceneRefused& refusal, TimePoint now);

    void handle(SessionRecord& session, const wire::ReadScene& request);
    void handle(SessionRecord& session, const wire::LockObjects& request);
    void handle(SessionRecord& session, wire::SetPresence request, TimePoint now);
    void handle(SessionRecord& session, const wire::ReadMembers& request, TimePoint now);
    void handle(SessionRecord& session, const wire::ReadHistory& request);
    void handle(SessionRecord& session, const wire::ReadWriters& request);
    void handle(SessionRecord& session, wire::RequestView request, TimePoint now);
    void handle(SessionRecord& session, const wire::SetViewFilter& request, TimePoint now);

    // Jobs of this scene, and finished jobs of any scene; for any client.
    void handle(SessionRecord& session, const wire::ReadJobs& request, TimePoint now);
    void handle(SessionRecord& session, const wire::FetchJob& request);
    void handle(SessionRecord& session, const wire::CancelJob& request);

    // Returns "" or an error message.
    std::string open_display(const scene::BlobPtr& description, std::vector<scene::BlobPtr> content,
                             TimePoint now);
    void handle(SessionRecord& session, const wire::CloseDisplay& request);
    void handle(SessionRecord& session, const wire::AdjustDisplay& request);
    void handle(SessionRecord& session, const wire::JoinOutput& request, TimePoint now);

    net::Bytes trace(const wire::ReadTrace& request) const;  // the encoded reply, with as many edits as fit

    // Takes results of the rendering threads; results of other scenes are ignored.
    void take(RenderOutput& output, TimePoint now);
    void tick(TimePoint now);
    // Writes what is new since the last checkpoint. True: it is written, or there is nothing to write. To be called
    // again, with take() in between, until it is or time is up.
    bool save_at_the_end(TimePoint now);
    TimePoint next_event(TimePoint now) const;
    session::SceneStatus status() const;

  private:
    struct Member {
        std::string name;
        std::uint64_t key = 0;
        wire::SetPresence presence;
        TimePoint presence_until{};
    };

    void open(wire::RecordedTitle scene);
    std::string unique_name(const std::string& wanted) const;
    void done(const SessionRecord& session, std::uint64_t request, std::string problem);
    void follow_display(TimePoint now);
    void publish_if_due(TimePoint now);
    void keep_journal(TimePoint now);
    void write_saved_views(TimePoint now);
    std::string open_view(const SessionRecord& session, std::uint64_t number,
                          const session::ViewRequest& wanted, TimePoint now);
    std::string viewer_problem(const SessionRecord& session, std::uint64_t number,
                               const session::ViewRequest& wanted) const;
    std::string submission_problem(const SessionRecord& session, const session::ViewRequest& wanted) const;
    void record_job(const std::string& name);
    void add_new_jobs(std::vector<wire::SavedView>& saved) const;
    void store_finished_jobs(TimePoint now);
    void withdraw_unbuildable(const std::string& reason, TimePoint now);
    void close_when_left(TimePoint now);
    const ViewState* job_view(const session::JobName& job) const;

    MasterServices services_;
    Duration owner_timeout_;
    std::uint64_t memory_limit_;
    SceneAuthority authority_;
    SceneEncoder encoder_;
    SceneDistributor distributor_;
    SceneReads reads_;
    BlobCollector collector_;
    Views views_;
    DisplayService display_;
    std::optional<SessionJournal> journal_;
    bool open_ = false;
    wire::RecordedTitle scene_;
    std::optional<TimePoint>
        owner_missing_since_;  // a recovered exclusive scene: since when it waits for its owner
    std::map<SessionId, Member> members_;
    TimePoint published_at_{};
    std::uint64_t published_transactions_ = 0;  // up to the published version
    std::uint64_t built_transactions_ = 0;      // up to the latest version that a node has built
    std::uint64_t progress_being_saved_ = 0;
    session::SceneStatus counts_;
    EditTraceLog traces_;
};

}  // namespace tessera::master
