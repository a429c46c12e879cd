#pragma once

#include <vector>

#include "master/filter/svgf/edge_stops.h"

namespace tessera::filter::svgf {

// The surfaces behind the pixels.
struct Guides {
    Planes normal;         // 3: unit, 0 where nothing was hit
    Planes inverse_depth;  // 1: 1 / z-distance, 0 where nothing was hit. On a plane it is linear in x and y.
    Planes slope;          // 2: its change per pixel to the right and down, of both sides the smaller one
    std::vector<std::uint32_t> ids;
    view::CameraPose camera;
};

// Everything but the slopes. Inputs must have Normal, Depth and object ids. False: stopped.
bool prepare_guides(const Inputs& inputs, Guides& guides, RunContext& context);
// Once the holes are filled.
bool prepare_slopes(Guides& guides, RunContext& context);

}  // namespace tessera::filter::svgf
