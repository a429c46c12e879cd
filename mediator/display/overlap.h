#pragma once

#include <tbb/task_arena.h>

#include <cstdint>
#include <span>
#include <vector>

#include "mediator/display/point_grid.h"
#include "mediator/view/view.h"

namespace tessera::display {

// One of several projectors that throw their pictures onto one screen.
struct Thrower {
    view::CameraPose projector;  // in display space
    PointGrid points;            // where on the screen its picture is seen
    std::uint32_t width = 0, height = 0;
};

// For each pixel of a projector's picture, row by row from the top: Blend's weights and lift.
struct OverlapMaps {
    std::vector<float> weights;
    std::vector<float> lift;  // empty when black is dark
};

// At a point of the screen a projector that reaches it has the weight d^2 / (sum of all projectors' d^2), d
// being the pixels from the point to the nearest edge of its picture: in linear light the weights of a point
// add up to one. The square makes weights begin without a slope, so the width of the outermost pixel and a
// small misplacement do not show.
//
// `black`, in [0, 1), is the light of a projector that is sent black, as a part of its white, the same for
// all. Where the most projectors overlap it adds up; everywhere else the lift brings it to the same, and
// weights shrink a little so that white is the same, too.
std::vector<OverlapMaps> overlap(std::span<const Thrower> throwers, double black, tbb::task_arena& arena);

}  // namespace tessera::display
