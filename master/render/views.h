#pragma once

#include <optional>
#include <string>
#include <vector>

#include "master/render/lockstep_group.h"
#include "master/render/picks.h"
#include "master/render/view_runner.h"
#include "master/render/view_saver.h"
#include "mediator/scene/scene.h"

namespace tessera::master {

// Shared by all scenes of a master.
struct RenderServices {
    RenderOutputs& outputs;
    FilmStore& film;
    Dispatcher& dispatcher;
    ViewIds& ids;
};

// The views of a scene. Renders all of them concurrently, each until its stop rule is met, coarse passes first, then
// in turn. A view whose owner waits for the end and one that streams every picture differ only in delivery. Driven by
// the scene session; owns no socket.
class Views {
  public:
    Views(const ViewSettings& settings, const RenderServices& services, SessionTable& sessions,
          Outbox& outbox, const EventSink& events, std::function<std::string(ObjectId)> name_of);

    // ---- clients ----
    struct SceneInFilm {
        Version version;
        Hash128 hash;
    };
    // Film of this scene and view that a new view goes on with.
    struct Continued {
        std::optional<EarlierFilm> film;
        std::string kind;  // of the nodes that rendered it
    };
    // Again with the same number: changes camera, size or quality; changing only the filter keeps the film, as long as it
    // can get the channels that the filter needs. Returns "" or the problem.
    std::string open(const ViewOwner& owner, std::uint64_t number, session::ViewRequest request,
                     const SceneInFilm& scene, TimePoint now, Continued&& continued = {});
    // Watches the existing view of this name.
    std::string share(SessionId session, std::uint64_t number, const session::ViewRequest& wanted);
    // Stops watching the view; or ends it with its current samples.
    void end(SessionId session, const wire::EndView& request, TimePoint now);
    // Why there is no room for a view if the other one goes for it; "" = there is.
    using RoomProblem = std::function<std::string(const session::ViewRequest& completed, ViewId replaced)>;
    // Sets the filter of the view of that name; "" = the only view, or the only one that the client may change. Its
    // owner may, other sessions with the owner's key, and operators. Returns a description of the effect; throws
    // Error{Refused} with the reason.
    std::string set_filter(const SessionRecord& asker, const std::string& name, const std::string& filter,
                           const RoomProblem& room_problem, TimePoint now);
    // ---- jobs: views that continue without their client ----
    // Why it cannot be a job; "" = it can.
    static std::string job_problem(const session::ViewRequest& request);
    std::vector<Delivery::Ended> take_ended_jobs() { return delivery_.take_ended(); }
    // Ends the job; other watchers keep watching the view.
    void release(ViewId view);
    void stop_keeping(ViewId view) { delivery_.release(view); }  // the view stays
    bool is_job(ViewId view) const { return delivery_.is_kept(view); }
    bool has_jobs() const;
    // How long a job whose client was lost is kept; nothing for one that was submitted as a job.
    std::optional<Duration> orphan_time(const ViewState& view, TimePoint now) const;
    session::ViewProgress progress(const ViewState& view) const { return runner_.progress(view); }
    void send_kept(const SessionRecord& session, Delivery::Ended kept) {
        delivery_.send_kept(session, std::move(kept));
    }
    // Clients that do not read their pictures; to be called regularly.
    std::vector<SessionId> not_reading(TimePoint now) {
        return delivery_.stalled(now, settings_.unread_limit);
    }
    std::size_t frames_in_flight(SessionId session) const { return delivery_.in_flight(session); }

    std::optional<ViewId> watched(SessionId session, std::uint64_t number) const {
        return delivery_.watched(session, number);
    }
    void taken(SessionId session, const wire::FrameTaken& taken) { delivery_.taken(session, taken); }
    void pick(SessionId session, const wire::Pick& request, Version version);
    // On a timeout its views are kept for a while: frames whose end it waits for as jobs, which others can fetch.
    enum class DisconnectReason { Graceful, Timeout };
    void session_left(SessionId session, DisconnectReason reason, TimePoint now);
    void session_resumed(SessionId session) { delivery_.resumed(session); }
    void close_all();

    // ---- scene ----
    // No view awaits its first picture. Changes wait until then, and no pass begins while they wait.
    bool may_publish() const;
    void pause_passes(bool hold) { table_.passes_paused = hold; }
    // Returns whether pictures restart.
    bool scene_changed(const scene::ChangeList& changes, const scene::Scene& after);
    void scene_facts(const SceneFacts& facts) { table_.facts = facts; }
    // The master's byte counters: baseline of the views' traffic.
    void charge_from(const session::WireBytes& bytes) { table_.bytes_at_start = bytes; }
    // Views of a previous run: they wait for their owners. Films of this scene are continued.
    void restore(std::vector<wire::SavedView>&& saved, Version version, Hash128 scene_hash, TimePoint now);

    // ---- events ----
    void took(const MergeReport& report, Dispatcher::Taken taken, TimePoint now);
    bool take(RenderOutput& output, TimePoint now);  // false: not for views
    std::vector<FirstPicture> take_first_pictures();

    // ---- time: first advance(), then the consumer of the group, then deal() ----
    void advance(TimePoint now);
    void deal(TimePoint now);
    TimePoint next_event(TimePoint now) const;

    const ViewTable& table() const { return table_; }
    const Dispatcher& dispatcher() const { return services_.dispatcher; }
    std::uint64_t watchers(ViewId view) const { return delivery_.watchers(view); }
    ViewSaver& saver() { return saver_; }
    // Views in lockstep. Its consumer calls these, so that first pictures are reported.
    LockstepGroup& group() { return group_; }
    void restart_group(const std::vector<GroupView>& wanted, TimePoint now);
    std::optional<GroupStage> next_group_stage(LockstepGroup::Consumer consumer, TimePoint now);
    void close_group();
    void reconstruct_output(OutputRequest request) { services_.film.reconstruct_output(std::move(request)); }

  private:
    ViewState* find_or_add(const ViewOwner& owner, std::uint64_t number, const std::string& name,
                           std::string& problem);
    std::string name_of_unnamed(const ViewOwner& owner, std::uint64_t number) const;
    ViewState& view_to_filter(const SessionRecord& asker, const std::string& name);
    // again: from the start, even if the request is the same.
    void change(ViewState& view, session::ViewRequest&& request, const SceneInFilm& scene, bool again,
                TimePoint now);
    void remove(ViewId view);
    void forget_orphans(TimePoint now);
    void deliver(TimePoint now);

    ViewSettings settings_;
    RenderServices services_;
    ViewTable table_;
    PassStarter passes_;
    Delivery delivery_;
    ViewRunner runner_;
    LockstepGroup group_;
    Picks picks_;
    ViewSaver saver_;
    std::uint64_t turn_ = 0;  // round robin among equal views
};

}  // namespace tessera::master
