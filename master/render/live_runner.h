#pragma once

#include <functional>
#include <list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "master/peers/event.h"
#include "master/peers/node_table.h"
#include "master/peers/outbox.h"
#include "master/render/film_merger.h"
#include "master/render/frame_sender.h"
#include "master/render/live_view.h"
#include "master/render/percentiles.h"
#include "master/render/view_group.h"
#include "mediator/scene/scene.h"
#include "mediator/wire/journal_records.h"

namespace tessera::master {

struct LiveSettings {
    Duration overdue_patience = std::chrono::seconds(5);      // film neither in hand nor here: lost
    Duration orphan_patience = std::chrono::seconds(60);      // a view whose owner fell silent waits so long
    Duration frame_interval = std::chrono::milliseconds(33);  // between pictures of the same pass
    std::uint32_t failure_limit = 8;
    Duration patience_without_nodes = std::chrono::seconds(3);  // before its owner is told that a view waits
    std::size_t max_views = 60;  // of all members: a node keeps 256, and each has four passes
};

// Renders the views of a live scene on the cluster, all of them at a time: coarse passes first, then in turn.
// Told of events by the render master; owns no socket.
class LiveRunner {
  public:
    LiveRunner(const LiveSettings& settings, NodeTable& nodes, SessionTable& sessions, Outbox& outbox,
               EventSink events, std::function<void()> wake);

    // A first picture of `version` is merged.
    std::function<void(Version version, TimePoint now)> on_first_picture;

    // Who opens a view. Whoever has the same user and key is the same.
    struct Owner {
        SessionId session;
        std::string name, user;
        std::uint64_t key = 0;
    };
    // Again with the same number: another camera, size or quality. "" or what is wrong with it.
    std::string open(const Owner& owner, wire::OpenLiveView request, Version version, TimePoint now);
    void close(SessionId session, std::uint64_t number);
    void taken(SessionId session, const wire::FrameTaken& taken) { frames_.taken(session, taken); }
    void pick(SessionId session, const wire::Pick& request, Version version, TimePoint now);
    // Its views stay for a while when it only fell silent.
    enum class Departure { Goodbye, Silence };
    void session_left(SessionId session, Departure departure, TimePoint now);
    void session_resumed(SessionId session) { frames_.resumed(session); }
    void close_all();

    // Views in lockstep instead of those there were. They take their turns with all others.
    void open_group(GroupOwner owner, std::uint64_t spp, std::uint32_t coarsest, Version version);
    void close_group();
    void group_changed();  // its pictures start anew
    // The films that there are are taken once more, as soon as that can be.
    void take_group_again();
    // From GroupOwner::take. What becomes of it goes to on_output, in the order of the orders.
    void make_output(OutputOrder order);
    std::function<void(MadeOutput&& made, TimePoint now)> on_output;

    // No first picture is on its way. Changes wait for it, and no pass begins while they wait.
    bool may_publish() const;
    void hold_passes(bool hold) { passes_held_ = hold; }
    // Whether pictures start anew.
    bool scene_changed(const scene::ChangeList& changes, const scene::Scene& after, TimePoint now);

    // Has all films copied; they are there when take_saved() brings them. `scene_hash`: of what they show.
    void save(Hash128 scene_hash);
    bool is_saving() const { return saving_.has_value(); }
    std::optional<std::vector<wire::SavedView>> take_saved();
    // Grows whenever there is more or other film to save.
    std::uint64_t film_progress() const;
    // Of a master before: they wait for their owners. Films go on where they show this scene.
    void restore(std::vector<wire::SavedView>&& saved, Version version, Hash128 scene_hash, TimePoint now);

    bool holds(UnitId unit) const { return unit >= FirstLiveUnit; }
    void film(net::PeerId bulk_peer, net::Bytes message) { merger_.push(bulk_peer, std::move(message)); }
    void released(NodeRecord& node, const wire::UnitReleased& release, TimePoint now);
    void goodbye(NodeRecord& node, const wire::Goodbye& goodbye);
    void node_gone(NodeId node);

    void tick(TimePoint now);
    TimePoint next_event(TimePoint now) const;

    const std::map<ViewId, LiveView>& views() const { return views_; }
    std::uint64_t watchers(ViewId view) const { return frames_.watchers(view); }
    const wire::UnitCounts& counts() const { return counts_; }
    std::uint64_t malformed_film() const { return malformed_film_; }
    // From the order to stop to the node's word that it has.
    const Percentiles& cancellations() const { return cancellations_; }
    const Balancer& balancer() const { return balancer_; }

  private:
    // What is under a pixel: one sample of a view that sees nothing else.
    struct PickTask {
        SessionId session;
        wire::Pick request;
        Version version;
        LivePass pass;
        glm::dvec3 eye{0.0}, direction{0.0};
        double along_axis = 1.0;  // distance along the ray = depth along the view's axis x this
        bool copied = false;
    };

    void restart(LiveView& live);
    void begin_pass(LivePass& pass, Version version, std::vector<frame::FilmTile>&& film = {});
    void advance(LiveView& live, TimePoint now);
    void show(LiveView& live, TimePoint now);
    void end(LivePass& pass);
    void end_passes(LiveView& live);
    bool group_is_protected() const;
    std::uint32_t group_tile_edge(const view::View& view, Version version) const;
    void restart_group();
    void begin_group_pass(LiveView& live);
    void advance_group(TimePoint now);
    void retake_group(TimePoint now);
    GroupStage stage_of_group() const;
    void show_group(bool is_last, TimePoint now);
    void fail(LiveView& live, const std::string& problem);
    void tell_of_waiting(LiveView& live, TimePoint now);
    void tell_owner(const LiveView& live, const std::string& text);
    void remove(ViewId view);
    void deal(TimePoint now);
    void deal(LivePass& pass, Version version, std::vector<NodeCapacity>& capacities, TimePoint now);
    void collect_overdue(TimePoint now);
    void take_merger_output(TimePoint now);
    void take(const MergeReport& report, TimePoint now);
    void take(FilmBlocks&& film);
    void take_copy(FilmBlocks&& film);
    void answer(PickTask& task, const frame::FilmTile& film);
    void refuse_pick(const PickTask& task, const std::string& problem);
    void cancel(const std::vector<Cancellation>& cancellations);
    void confirm_cancelled(UnitId unit, TimePoint now);
    void send_frames(TimePoint now);
    LivePass* pass_of(UnitId unit);
    LivePass* pass_of(ViewId view);
    LiveView* view_of(ViewId pass);
    UnitId next_units();

    // A save under way.
    struct Saving {
        std::map<ViewId, wire::SavedView> views;
        std::map<ViewId, std::uint64_t> revisions;  // of the views whose film is being copied
        std::set<ViewId> waiting;                   // films
    };

    LiveSettings settings_;
    NodeTable& nodes_;
    SessionTable& sessions_;
    Outbox& outbox_;
    EventSink events_;
    FilmMerger merger_;
    Balancer balancer_;
    FrameSender frames_;
    std::map<ViewId, LiveView> views_;
    std::list<PickTask> picks_;
    std::optional<Saving> saving_;
    std::optional<ViewGroup> group_;
    std::uint64_t next_view_ = FirstLiveView.value, next_unit_ = FirstLiveUnit.value;
    std::uint64_t turn_ = 0;  // whose turn it is among equals
    bool passes_held_ = false;
    TimePoint now_{};  // of the latest event
    wire::UnitCounts counts_;
    std::uint64_t malformed_film_ = 0;
    std::map<UnitId, TimePoint> cancelled_;  // not confirmed yet
    Percentiles cancellations_;
};

}  // namespace tessera::master
