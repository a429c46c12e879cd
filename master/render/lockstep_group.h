#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "master/render/pass_starter.h"

namespace tessera::master {

// One of the views of a lockstep group.
struct GroupView {
    std::string name;
    view::View view;             // id and revision are the group's
    std::uint32_t priority = 1;  // a power of two: samples a pixel, compared with the others
};

// A consistent state of all views of a group: same scene, revision, resolution scale and samples per pixel
// (times the priority), in views with steps in the mean. When films are resampled, pixels may have different, higher sample
// counts.
struct GroupStage {
    SceneState scene;
    std::vector<view::View> views;  // as rendered at this stage; their films are complete
    std::uint32_t scale = 1;        // 8, 4, 2: a coarse picture at 1/scale of the size
};

// Views that progress in lockstep. Their consumer provides the views at every restart and consumes one stage
// after another. The views are scheduled in turn with all others of the table.
class LockstepGroup {
  public:
    LockstepGroup(ViewTable& views, PassStarter& passes) : views_(views), passes_(passes) {}

    void open(std::uint64_t spp, std::uint32_t coarsest, Version version);
    std::vector<ViewId> close();  // views to be removed
    bool is_open() const { return open_.has_value(); }

    void changed();   // restarts its pictures
    void resample();  // the current films are consumed again, as soon as possible
    void scene_changed(Version version, bool restarts);

    // A restart is wanted and possible: the consumer calls restart() with the current views (none if nothing is
    // visible), which returns the views to be removed.
    bool is_restart_due() const;
    std::vector<ViewId> restart(const std::vector<GroupView>& wanted, TimePoint now);

    // The next stage, which the consumer must use before the next call. The first stage after a change and the last
    // one wait for a busy consumer; others are skipped.
    enum class Consumer { Free, Busy };
    std::optional<GroupStage> advance(Consumer consumer);
    // The next step of one of its views.
    void take(ViewState& view, StepDecision&& decision);
    // The last advance() returned the first stage since the restart.
    bool is_first_stage() const { return open_ && open_->is_first_stage; }
    const std::vector<ViewId>& views() const;

  private:
    struct Open {
        std::uint64_t spp = 1;       // final, of priority 1
        std::uint32_t coarsest = 8;  // 1: no coarse pictures
        Version version;             // of the scene, published
        std::vector<ViewId> views;
        std::uint64_t samples = 0;  // of the current stage, when it has the full size
        // Of the views with steps: the next ones, as they are decided; with one of each they begin.
        std::map<ViewId, std::vector<Round>> decided;
        bool is_deciding = false;
        bool has_last_samples = false;  // no view has another step
        bool restart_wanted = true;
        bool resample_wanted = false;
        bool first_is_consumed = false, is_first_stage = false;
        bool complete = false;
    };
    void begin_pass(ViewState& view);
    std::uint32_t tile_edge(const view::View& view) const;
    bool is_stage_done() const;
    bool is_whole() const;
    bool mark_shown(bool is_last);
    bool is_last_stage() const;
    std::vector<ViewState*> views_with_steps();
    void request_step(ViewState& view);
    void advance_views();
    GroupStage stage() const;

    ViewTable& views_;
    PassStarter& passes_;
    std::optional<Open> open_;
};

}  // namespace tessera::master
