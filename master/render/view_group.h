#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "mediator/base/clock.h"
#include "mediator/base/ids.h"
#include "mediator/view/view.h"

namespace tessera::master {

// One of the views that go in lockstep.
struct GroupView {
    std::string name;
    view::View view;             // id and revision are the runner's
    std::uint32_t priority = 1;  // a power of two: samples a pixel, compared with the others
};

// A moment at which all views of a group show the same: scene, revision, part of the size, samples per pixel
// (times the priority). Films that are taken again may have more samples by then, each pixel its own number.
struct GroupStage {
    Version version;
    std::vector<view::View> views;  // as they are rendered at this stage; their films are there
    std::uint32_t scale = 1;        // 8, 4, 2: a coarse picture of this part of the size
};

// Whose views they are. All is called from the master's loop.
struct GroupOwner {
    // What is to be seen now; asked when pictures start anew, so the latest counts. Empty: nothing can be
    // seen.
    std::function<std::vector<GroupView>()> views;
    // Could take a stage. The first one after a change, and the last, wait for that; others are left out.
    std::function<bool()> can_take;
    // To order pictures of the films, at once: the next stage changes them.
    std::function<void(const GroupStage&, TimePoint)> take;
};

// Where a group is.
struct ViewGroup {
    GroupOwner owner;
    std::uint64_t spp = 1;       // of priority 1, in the end
    std::uint32_t coarsest = 8;  // 1: no coarse pictures
    Version version;             // of the scene, published
    std::vector<ViewId> views;
    std::uint64_t samples = 0;  // the stage under way, when it is one of the whole size
    bool restart_wanted = true;
    bool retake_wanted = false;
    bool first_is_taken = false;
    bool complete = false;
};

}  // namespace tessera::master
