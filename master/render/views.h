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

// What all scenes of a master render with.
struct RenderServices {
    RenderOutputs& outputs;
    FilmStore& film;
    Dispatcher& dispatcher;
    ViewIds& ids;
};

// The views of a scene: renders all of them at a time, each until its stop rule says so, coarse passes first,
// then in turn. A view whose owner waits for the end and one whose every picture is watched differ in what is
// delivered of them, and in nothing else. Told of events by the scene session; owns no socket.
class Views {
  public:
    Views(const ViewSettings& settings, const RenderServices& services, SessionTable& sessions,
          Outbox& outbox, const EventSink& events);

    // ---- clients ----
    // Again with the same number: another camera, size or quality; a filter alone keeps the film. "" or what
    // is wrong with it.
    std::string open(const ViewOwner& owner, std::uint64_t number, session::ViewRequest request,
                     Version version, TimePoint now);
    // Watches the view that has this name, whatever it shows.
    std::string share(SessionId session, std::uint64_t number, const session::ViewRequest& wanted);
    // It is watched no more; or it ends with what there is.
    void end(SessionId session, const wire::EndView& request, TimePoint now);
    // Another filter for the view of that name; "" = the one there is. Says what it means for the frame; throws
    // Error{Refused} with the reason.
    std::string set_filter(const std::string& name, const std::string& filter, TimePoint now);
    // ---- jobs: views that go on without their client ----
    // What is wrong with it as a job; "" = nothing.
    static std::string job_problem(const session::ViewRequest& request);
    std::vector<Delivery::Ended> take_ended_jobs() { return delivery_.take_ended(); }
    // It has ended, or is not wanted any more; whoever else watches it goes on.
    void release(ViewId view);
    bool is_job(ViewId view) const { return delivery_.is_kept(view); }
    bool has_jobs() const;
    session::ViewProgress progress(const ViewState& view) const { return runner_.progress(view); }
    void send_kept(const SessionRecord& session, Delivery::Ended kept) {
        delivery_.send_kept(session, std::move(kept));
    }
    std::size_t frames_on_their_way(SessionId session) const { return delivery_.on_their_way(session); }

    void taken(SessionId session, const wire::FrameTaken& taken) { delivery_.taken(session, taken); }
    void pick(SessionId session, const wire::Pick& request, Version version);
    // Its views stay for a while when it only fell silent.
    enum class Departure { Goodbye, Silence };
    void session_left(SessionId session, Departure departure, TimePoint now);
    void session_resumed(SessionId session) { delivery_.resumed(session); }
    void close_all();

    // ---- scene ----
    // No first picture is on its way. Changes wait for it, and no pass begins while they wait.
    bool may_publish() const;
    void hold_passes(bool hold) { table_.passes_held = hold; }
    // Whether pictures start anew.
    bool scene_changed(const scene::ChangeList& changes, const scene::Scene& after);
    void scene_facts(const SceneFacts& facts) { table_.facts = facts; }
    // The master's bytes so far: from here on views are charged with them.
    void charge_from(const session::WireBytes& bytes) { table_.bytes_at_start = bytes; }
    // The views of a master before: they wait for their owners. Films go on where they show this scene.
    void restore(std::vector<wire::SavedView>&& saved, Version version, Hash128 scene_hash, TimePoint now);

    // ---- events ----
    void took(const MergeReport& report, Dispatcher::Taken taken, TimePoint now);
    void unit_failed(const Dispatcher::Failure& failure, TimePoint now);
    bool take(RenderOutput& output, TimePoint now);  // false: not for views
    std::vector<FirstPicture> take_first_pictures();

    // ---- time: first advance(), then whoever consumes the group, then deal() ----
    void advance(TimePoint now);
    void deal(TimePoint now);
    TimePoint next_event(TimePoint now) const;

    const ViewTable& table() const { return table_; }
    const Dispatcher& dispatcher() const { return services_.dispatcher; }
    std::uint64_t watchers(ViewId view) const { return delivery_.watchers(view); }
    ViewSaver& saver() { return saver_; }
    // Views in lockstep. What it consumes is told here, so that it becomes an event and reaches watchers.
    LockstepGroup& group() { return group_; }
    void restart_group(const std::vector<GroupView>& wanted, TimePoint now);
    std::optional<GroupStage> next_group_stage(LockstepGroup::Consumer consumer, TimePoint now);
    void close_group();
    void make_output(OutputOrder order) { services_.film.make_output(std::move(order)); }

  private:
    ViewState* find_or_add(const ViewOwner& owner, std::uint64_t number, const std::string& name,
                           std::string& problem);
    ViewState& view_to_filter(const std::string& name);
    void change(ViewState& view, session::ViewRequest&& request, Version version, TimePoint now);
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
    std::uint64_t turn_ = 0;  // whose turn it is among equals
};

}  // namespace tessera::master
