#pragma once

#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "node/actions.h"
#include "node/held_film.h"
#include "node/work_queue.h"

namespace tessera::node {

// The result of a unit on its worker.
struct UnitOutcome {
    backend::RenderResult result;
    std::string error;  // not empty: the back-end's error, and how to reproduce it
    Duration busy{};
};

// Accepts units that match the open views and the scene's version, has them rendered and sends their film, or releases
// them with a reason. Every accepted unit is answered exactly once. Pure; single-threaded.
class UnitTracker {
  public:
    UnitTracker(std::uint32_t workers, const backend::Capabilities& capabilities, const SceneReplica& replica,
                Effects& effects);

    void open(const wire::OpenView& open);  // the film of its units may be held back for `open.hold_film`
    void close(const wire::CloseView& close);
    void work(const wire::Work& work, bool leaving);
    void cancel(const wire::CancelUnits& cancel);
    void finished(UnitId unit, UnitOutcome&& outcome, TimePoint now);
    void film_sent(UnitId unit);
    void film_withdrawn(UnitId unit);
    // Sends film whose other half is not coming, or that has been held for long enough.
    void send_ready(TimePoint now);
    std::optional<TimePoint> next_event() const;  // of send_ready()

    void dispatch();         // to free workers, unless the scene is being built
    void version_ends();     // releases units that wait for the current version
    void recheck_waiting();  // releases units that can no longer be rendered
    void release_waiting(wire::ReleaseReason reason, const std::string& message, ViewId of_view = {});
    void hand_back();                    // releases all units, those being rendered with their whole blocks
    void stop_all();                     // without an answer
    void abandon();                      // the master has forgotten all units and views
    void welcomed(std::uint64_t epoch);  // sequence numbers restart

    bool empty() const { return queue_.empty(); }
    std::uint32_t free_slots() const { return queue_.free_slots(); }
    std::uint64_t last_sequence() const { return queue_.last_sequence(); }
    std::vector<UnitId> in_flight() const;  // without those that were abandoned
    std::vector<UnitId> latest_sent() const { return {sent_.begin(), sent_.end()}; }

  private:
    std::optional<std::pair<wire::ReleaseReason, std::string>> objection(const view::WorkUnit& unit) const;
    void release(UnitId unit, wire::ReleaseReason reason, std::string message);
    void release_held(ViewId view, const std::string& message);
    void stop_of(ViewId view);
    void stop(UnitId unit, wire::ReleaseReason reason);
    Duration hold_limit(ViewId view) const;  // how long film of it may wait
    void send_held(HeldFilm::Item&& item);
    void send_all_held();
    void send_parts(const view::WorkUnit& unit, UnitOutcome&& outcome);

    backend::Capabilities capabilities_;
    const SceneReplica& replica_;
    Effects& effects_;
    WorkQueue queue_;
    std::uint64_t epoch_ = 0;
    struct OpenedView {
        view::View view;
        Duration hold_film{};
    };
    std::map<ViewId, OpenedView> views_;
    HeldFilm held_;
    std::map<UnitId, wire::ReleaseReason> stopping_;           // being rendered and stopping, with the reason
    std::map<UnitId, wire::UnitReleased> release_after_film_;  // film parts are still queued
    std::set<UnitId> abandoned_;                               // being rendered, result unwanted
    std::deque<UnitId> sent_;                                  // the latest, for Goodbye
};

}  // namespace tessera::node
