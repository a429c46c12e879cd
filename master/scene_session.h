#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "master/display/display_service.h"
#include "master/job_store.h"
#include "master/peers/node_table.h"
#include "master/peers/session_table.h"
#include "master/render/view_memory.h"
#include "master/render/views.h"
#include "master/scene/authority_thread.h"
#include "master/scene/blob_collector.h"
#include "master/scene/edit_trace.h"
#include "master/scene/published_scene.h"
#include "master/scene/scene_authority.h"
#include "master/scene/scene_distributor.h"
#include "master/scene/scene_reads.h"
#include "master/scene/session_journal.h"
#include "mediator/frame/film_state.h"

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

// Of films, blobs and queues, in bytes.
struct MemoryUse {
    std::uint64_t used = 0, limit = 0;
    // Why there is no room for so many more bytes of `what`; "" = there is.
    std::string problem(std::uint64_t bytes, const std::string& what) const;
};

// Everything that belongs to one scene: content, edit history, replicas on nodes, views, display, files on disk,
// members and their requests. RenderMaster passes messages to it; results of the rendering threads are taken
// in tick().
//
// Edits are applied and answered immediately. A version is published as soon as no first picture is pending and
// the last version is at least 16 ms old.
class SceneSession {
  public:
    static constexpr Duration VersionInterval = std::chrono::milliseconds(16);
    // So long edits wait for views to show the version there is, or a drag would restart them before they show anything. No
    // longer: a view that never gets a frame must not keep the edits of others.
    static constexpr Duration FirstFrameWait = std::chrono::seconds(3);

    SceneSession(std::uint64_t epoch, const ViewSettings& settings, const MasterServices& services);

    // Records edits in the folder from now on, after reopening the session stored there. Throws Error if the
    // folder cannot be used.
    void record_to(const std::filesystem::path& folder, Duration checkpoint_interval, TimePoint now);

    const PublishedScene& published() const { return published_; }
    // True while the authority is on its thread: an edit is being applied or written to disk. What needs the authority
    // has to wait; see waits().
    bool is_editing() const { return thread_.is_busy(); }
    // Whether this message of the session has to wait while an edit is being applied.
    bool waits(const SessionRecord& session, const wire::ControlMessage& message) const;
    // What work on the authority costs: objects that it goes through; whether it has to wait for the disk.
    struct Cost {
        std::size_t objects = 0;
        bool writes = false;
    };
    Cost cost_of(const scene::Edit& edit) const { return {authority_.size_of(edit), true}; }
    // An edit was refused before it came to the authority. Not while is_editing().
    void refused(SessionId session, std::uint64_t sequence, std::string problem) {
        authority_.refused(session, sequence, std::move(problem));
    }
    // Runs `work` on the authority, then `then` in the event loop: immediately, or on the authority's thread if it costs
    // more than the loop can spare. Not while is_editing().
    void run(const Cost& cost, std::function<void(SceneAuthority&)> work, std::function<void(TimePoint)> then,
             TimePoint now);
    // Destroys something large on a thread.
    template <class T>
    void discard(T&& value) {
        thread_.discard(std::forward<T>(value));
    }
    SceneDistributor& distributor() { return distributor_; }
    const SceneDistributor& distributor() const { return distributor_; }
    MemoryUse memory() const { return memory_with(view_memory()); }
    // Why the master has no room for so many more bytes of `what`; "" = it has.
    std::string memory_problem(std::uint64_t bytes, const std::string& what) const;
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
    // Opens a scene if none is open, and sends the answer. Throws Error if the session may not join. Not while
    // is_editing(), like all requests that wait for it.
    void join(SessionRecord& session, const wire::JoinScene& request, TimePoint now);
    // Removes all members and empties the scene; is_open() is false at once.
    void close(TimePoint now);
    // A member has left; an exclusive scene is closed.
    void left(SessionId session, Views::DisconnectReason reason, TimePoint now);

    // Called when a member's edit was answered.
    void edited(const SessionRecord& session, const scene::Edit& edit, const EditAnswer& answer,
                std::uint64_t message_bytes, TimePoint now);
    // The session can no longer edit; its locks are released.
    void forget_editor(SessionId session);
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
    // `film`: that a new view goes on with, as the request says.
    void handle(SessionRecord& session, const wire::RequestView& request, TimePoint now,
                std::optional<frame::FilmState>&& film = {});
    void handle(SessionRecord& session, const wire::SetViewFilter& request, TimePoint now);

    // Jobs of this scene, and finished jobs of any scene; for any client.
    void handle(SessionRecord& session, const wire::ReadJobs& request, TimePoint now);
    void handle(SessionRecord& session, const wire::FetchJob& request);
    void handle(SessionRecord& session, const wire::CancelJob& request, TimePoint now);

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

    void opened(wire::RecordedTitle scene);
    void joined(SessionId session, const wire::JoinScene& request, const IdRange& ids, TimePoint now);
    // Distributes the changes to nodes, views and display.
    void publish(scene::ChangeList&& changes, TimePoint now);
    void publish_edits(std::function<void(TimePoint)> then, TimePoint now);
    void catch_up_with_edits(TimePoint now);
    // The render origin follows the eye; then `then` is called, unless an edit is running.
    void follow(const glm::dvec3& eye, TimePoint now, std::function<void(TimePoint)> then = {});
    std::string unique_name(const std::string& wanted) const;
    void done(const SessionRecord& session, std::uint64_t request, std::string problem);
    void follow_display(TimePoint now);
    void publish_if_due(TimePoint now);
    void keep_journal(TimePoint now);
    void write_saved_views(TimePoint now);
    // "" or why the view cannot be opened.
    ViewMemory view_memory(std::optional<ViewId> left_out = std::nullopt) const;
    MemoryUse memory_with(const ViewMemory& views) const;
    // Why there is no room for this view. `replaced`: a view that goes for it.
    std::string memory_problem(const session::ViewRequest& completed, std::optional<ViewId> replaced) const;
    std::string view_problem(const SessionRecord& session, std::uint64_t number,
                             const session::ViewRequest& wanted) const;
    void open_view(SessionId session, const wire::RequestView& request,
                   std::optional<frame::FilmState>&& film, TimePoint now);
    void view_opened(SessionId session, const wire::RequestView& request, const std::string& problem);
    // "" or why film of a client cannot be continued.
    std::string film_problem(const wire::EarlierFilm& film) const;
    std::string viewer_problem(const SessionRecord& session, std::uint64_t number,
                               const session::ViewRequest& wanted) const;
    std::string submission_problem(const SessionRecord& session, const session::ViewRequest& wanted) const;
    void record_job(SessionId session, const wire::RequestView& request, TimePoint now);
    void record_job_ends(std::vector<session::JobName> jobs, TimePoint now);
    void add_new_jobs(std::vector<wire::SavedView>& saved) const;
    void store_finished_jobs(TimePoint now);
    void withdraw_unbuildable(const std::string& reason, TimePoint now);
    void close_when_left(TimePoint now);
    const ViewState* job_view(const session::JobName& job) const;

    MasterServices services_;
    Duration owner_timeout_;
    std::uint64_t memory_limit_;
    SceneAuthority authority_;  // not while is_editing()
    PublishedScene published_;
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
    std::optional<TimePoint> unpublished_since_;  // an edit waits to be published
    // What the end of the running edit is awaited for.
    std::optional<SessionId> requester_;  // whose later messages wait for it
    std::vector<SessionId> to_forget_;
    std::optional<glm::dvec3> to_follow_;
    std::string unbuildable_;  // why; "" = nothing is to be withdrawn
    // As of the last time that no edit was running.
    std::uint64_t transactions_ = 0, journal_bytes_ = 0;
    std::uint64_t published_transactions_ = 0;  // up to the published version
    std::uint64_t built_transactions_ = 0;      // up to the latest version that a node has built
    std::uint64_t progress_being_saved_ = 0;
    session::SceneStatus counts_;
    EditTraceLog traces_;
    AuthorityThread thread_;  // the last member, since its work uses the others
};

}  // namespace tessera::master
