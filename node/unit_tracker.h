#pragma once

#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "node/actions.h"
#include "node/work_queue.h"

namespace tessera::node {

// How a unit ended on its worker.
struct UnitOutcome {
    backend::RenderResult result;
    std::string error;  // not empty: the back-end gave up, and how to replay it
    Duration busy{};
};

// Units in, film out: takes what the open views and the scene's version allow, has it rendered, sends its film
// or hands it back with a reason. Every unit that was taken is answered once. Pure; one thread.
class UnitTracker {
  public:
    UnitTracker(std::uint32_t workers, const backend::Capabilities& capabilities, const SceneReplica& replica,
                Effects& effects);

    void open(const wire::OpenView& open);
    void close(const wire::CloseView& close);
    void work(const wire::Work& work, bool leaving);
    void cancel(const wire::CancelUnits& cancel);
    void finished(UnitId unit, UnitOutcome&& outcome);
    void film_sent(UnitId unit);

    void dispatch();       // to free workers, unless the scene is being built
    void version_ends();   // what waits for the present version is handed back
    void judge_waiting();  // what cannot be rendered any more is handed back
    void release_waiting(wire::ReleaseReason reason, const std::string& message, ViewId of_view = {});
    void stop_all();                     // without an answer
    void abandon();                      // the master knows nothing of units and views any more
    void welcomed(std::uint64_t epoch);  // numbers of work begin anew

    bool empty() const { return queue_.empty(); }
    std::uint32_t free_places() const { return queue_.free_places(); }
    std::uint64_t last_sequence() const { return queue_.last_sequence(); }
    std::vector<UnitId> in_hand() const;  // without those that were abandoned
    std::vector<UnitId> latest_sent() const { return {sent_.begin(), sent_.end()}; }

  private:
    std::optional<std::pair<wire::ReleaseReason, std::string>> objection(const view::WorkUnit& unit) const;
    void release(UnitId unit, wire::ReleaseReason reason, std::string message);
    void stop_of(ViewId view);
    void stop(UnitId unit, wire::ReleaseReason reason);
    void send_film(const view::WorkUnit& unit, UnitOutcome&& outcome);

    backend::Capabilities capabilities_;
    const SceneReplica& replica_;
    Effects& effects_;
    WorkQueue queue_;
    std::uint64_t epoch_ = 0;
    std::map<ViewId, view::View> views_;
    std::map<UnitId, wire::ReleaseReason> stopping_;           // being rendered, told to stop, and why
    std::map<UnitId, wire::UnitReleased> release_after_film_;  // its parts are on their way
    std::set<UnitId> abandoned_;                               // being rendered for nobody
    std::deque<UnitId> sent_;                                  // the latest, for the goodbye
};

}  // namespace tessera::node
