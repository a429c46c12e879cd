#pragma once

#include <tbb/task_arena.h>

#include <cstdint>
#include <span>
#include <vector>

#include "mediator/display/warp_map.h"
#include "mediator/view/view.h"

namespace tessera::display {

// One of several projectors on the same screen, and its picture.
struct ProjectorOutput {
    view::CameraPose projector;  // in display space
    WarpMap points;              // where its picture is on the screen
    std::uint32_t width = 0, height = 0;
};

// For each pixel of a projector's picture, row by row from the top: Blend's weights and lift.
struct OverlapMaps {
    std::vector<float> weights;
    std::vector<float> lift;  // empty when the black level is 0
};

// At a point of the screen a projector that covers it has the weight d^2 / (sum of all projectors' d^2), where d is the
// distance in pixels from the point to the nearest edge of its picture: in linear light the weights at a point add up
// to one. The square makes weights start with slope 0, which hides the width of the outermost pixel and small
// misalignment.
//
// `black`, in [0, 1), is the black level of all projectors, as a fraction of white. It adds up where projectors overlap;
// the lift raises it everywhere to the maximum of the screen, and weights are scaled so that white is uniform, too.
std::vector<OverlapMaps> overlap(std::span<const ProjectorOutput> projectors, double black,
                                 tbb::task_arena& arena);

}  // namespace tessera::display
