#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "master/render/pass_starter.h"

namespace tessera::master {

// One of the views that go in lockstep.
struct GroupView {
    std::string name;
    view::View view;             // id and revision are the group's
    std::uint32_t priority = 1;  // a power of two: samples a pixel, compared with the others
};

// A moment at which all views of a group show the same: scene, revision, part of the size, samples per pixel
// (times the priority). Films that are taken again may have more samples by then, each pixel its own number.
struct GroupStage {
    Version version;
    std::vector<view::View> views;  // as they are rendered at this stage; their films are there
    std::uint32_t scale = 1;        // 8, 4, 2: a coarse picture of this part of the size
};

// Views that go in lockstep, for whoever consumes their stages: it brings the views whenever pictures start
// anew, and takes one stage after another. The views take their turns with all others of the table.
class LockstepGroup {
  public:
    LockstepGroup(ViewTable& views, PassStarter& passes) : views_(views), passes_(passes) {}

    void open(std::uint64_t spp, std::uint32_t coarsest, Version version);
    std::vector<ViewId> close();  // these are to be removed
    bool is_open() const { return open_.has_value(); }

    void changed();     // its pictures start anew
    void take_again();  // the films that there are are taken once more, as soon as that can be
    void scene_changed(Version version, bool restarts);

    // Pictures are to start anew, and nothing speaks against it: restart() with what is to be seen now. No
    // views: nothing can be seen. Gives views that are to be removed.
    bool is_restart_due() const;
    std::vector<ViewId> restart(const std::vector<GroupView>& wanted, TimePoint now);

    // The next stage that the consumer is to take, at once: the call after it goes on. The first stage after a
    // change, and the last, wait for a busy consumer; others are left out.
    enum class Consumer { Free, Busy };
    std::optional<GroupStage> advance(Consumer consumer);
    // The views' first stage since the restart was taken by the last advance().
    bool is_first_stage() const { return open_ && open_->is_first_stage; }
    const std::vector<ViewId>& views() const;

  private:
    struct Open {
        std::uint64_t spp = 1;       // of priority 1, in the end
        std::uint32_t coarsest = 8;  // 1: no coarse pictures
        Version version;             // of the scene, published
        std::vector<ViewId> views;
        std::uint64_t samples = 0;  // the stage under way, when it is one of the whole size
        bool restart_wanted = true;
        bool retake_wanted = false;
        bool first_is_taken = false, is_first_stage = false;
        bool complete = false;
    };
    void begin_pass(ViewState& view);
    std::uint32_t tile_edge(const view::View& view) const;
    bool is_stage_done() const;
    bool is_whole() const;
    bool mark_shown(bool is_last);
    void go_on();
    GroupStage stage() const;

    ViewTable& views_;
    PassStarter& passes_;
    std::optional<Open> open_;
};

}  // namespace tessera::master
