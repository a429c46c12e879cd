#pragma once

#include <string>
#include <vector>

#include "master/render/delivery.h"
#include "master/render/filter_change.h"
#include "master/render/pass_starter.h"
#include "master/render/time_budget.h"

namespace tessera::master {

struct ViewSettings {
    Duration overdue_patience =
        std::chrono::seconds(5);  // a unit that the node does not hold and whose film has not arrived: lost
    Duration orphan_patience = std::chrono::seconds(60);  // how long a view waits for an owner that timed out
    Duration orphan_limit = std::chrono::minutes(10);     // the same of a frame whose end its owner waits for
    // How long a client may leave a picture unread while others wait for its exclusive scene to end.
    Duration unread_limit = std::chrono::minutes(10);
    Duration frame_interval = std::chrono::milliseconds(33);  // between pictures of the same pass
    Duration progress_interval = std::chrono::milliseconds(100);
    Duration stop_grace = std::chrono::seconds(2);  // for film of cancelled units
    std::uint32_t failure_limit =
        8;  // tiles that fail before any other has samples: the view cannot be rendered
    std::uint32_t max_crashes = 2;  // nodes that samples may cost before they are left out
    Duration patience_without_nodes =
        std::chrono::seconds(3);  // before its owner is notified that a view waits
    std::size_t max_views = 60;   // of all members: a node keeps 256, and each view has several passes
};

// The first picture of a version is merged.
struct FirstPicture {
    Version version;
    TimePoint at{};
};

// Runs views through their passes: waits for nodes, plans the time budget, begins one pass after another, updates the
// displayed state, ends the view when its stop rule is met. Stateless regarding views; works on those of the table.
class ViewRunner {
  public:
    ViewRunner(const ViewSettings& settings, ViewTable& views, PassStarter& passes, Delivery& delivery,
               SessionTable& sessions, Outbox& outbox, EventSink events)
        : settings_(settings),
          views_(views),
          passes_(passes),
          delivery_(delivery),
          sessions_(sessions),
          outbox_(outbox),
          events_(std::move(events)) {}

    void restart(ViewState& view, TimePoint now);
    // Begins with the last pass and its existing film; of nodes of `kind`, if the view is reproducible.
    void resume(ViewState& view, EarlierFilm&& earlier, const std::string& kind, TimePoint now);
    // Called when time has passed or samples have arrived.
    void advance(ViewState& view, TimePoint now);
    void took(ViewState& view, const MergeReport& report, Dispatcher::Taken taken, TimePoint now);
    // Continues the film with another filter; not for a change that restarts.
    void change_filter(ViewState& view, const FilterChange& change, TimePoint now);
    void decide(ViewState& view, session::Outcome outcome, std::string message, TimePoint now);
    // It is not rendered any more, until its scene or request changes.
    void fail(ViewState& view, const std::string& problem, TimePoint now);

    void take(Reconstructed&& made, TimePoint now);
    void take(const CalibrationResult& calibration);
    void take(ViewState& view, StepDecision&& decision, TimePoint now);

    // Notifies the owner once that the view is waiting for nodes.
    void notify_waiting(ViewState& view, TimePoint now);
    void show_progress(ViewState& view, TimePoint now);
    session::ViewProgress progress(const ViewState& view) const;
    TimePoint next_event(const ViewState& view, TimePoint now) const;
    void is_first_picture(Version version, TimePoint now) { first_pictures_.push_back({version, now}); }
    std::vector<FirstPicture> take_first_pictures() { return std::exchange(first_pictures_, {}); }

  private:
    void wait_for_nodes(ViewState& view, TimePoint now);
    bool budget_is_planned(ViewState& view, TimePoint now);
    std::uint32_t scale_that_fits(const ViewState& view, TimePoint now) const;
    void begin_rendering(ViewState& view, TimePoint now);
    void begin_pass(ViewState& view, EarlierFilm&& earlier = {});
    PlanSettings plan_of(const ViewState& view) const;
    void advance_to_next_pass(ViewState& view, TimePoint now);
    void advance_picture(ViewState& view, TimePoint now);
    void request_step(ViewState& view, TimePoint now);
    bool drops_test_patterns(ViewState& view);
    void observe(ViewState& view, TimePoint now);
    void collect_failed_tiles(ViewState& view);
    bool fails_everywhere(const ViewState& view) const;
    void give_up(ViewState& view, TimePoint now);
    void account(ViewState& view, const MergeReport& report, Dispatcher::Taken taken);
    void show(ViewState& view, TimePoint now);
    void finish(ViewState& view, TimePoint now);
    void send_progress(ViewState& view, TimePoint now);
    void notify_owner(const ViewState& view, const std::string& text);
    NodeRequirements requirements(const ViewState& view) const {
        return {view.version, view.request.reproducible, view.run.kind};
    }

    const ViewSettings& settings_;
    ViewTable& views_;
    PassStarter& passes_;
    Delivery& delivery_;
    SessionTable& sessions_;
    Outbox& outbox_;
    EventSink events_;
    TimeBudget time_budget_;
    std::vector<FirstPicture> first_pictures_;
};

}  // namespace tessera::master
