#pragma once

#include <vector>

#include "master/filter/svgf/edge_stops.h"

namespace tessera::filter::svgf {

// The visible surfaces of the pixels.
struct Guides {
    Planes normal;         // 3: unit, 0 for misses
    Planes inverse_depth;  // 1: 1 / z-distance, 0 for misses. On a plane it is linear in x and y.
    Planes slope;          // 2: its change per pixel to the right and down, the smaller one of both sides
    std::vector<std::uint32_t> ids;
    view::CameraPose camera;
};

// Everything but the slopes. Inputs must have Normal, Depth and object ids. False: stopped.
bool prepare_guides(const Inputs& inputs, Guides& guides, RunContext& context);
// After the holes have been filled.
bool prepare_slopes(Guides& guides, RunContext& context);

}  // namespace tessera::filter::svgf
