#pragma once

#include <span>

#include "master/filter/svgf/guides.h"

namespace tessera::filter::svgf {

// When a place in the previous picture shows the same surface (Dundr 2.2, defaults of SVGF).
struct SurfaceTests {
    float depth_slopes = 10.0f;   // inverse depth may be off by so many slopes per pixel ...
    float depth = 0.01f;          // ... and this share of itself (the printed 0.01 is in units of one scene)
    float normal_slopes = 16.0f;  // |n - n'| <= normal_slopes (change of n per pixel + 0.01)
};

// Where every pixel's surface point was in the previous picture, for static surfaces.
struct Motion {
    Planes position;        // 2: x, y; a pixel's centre is its integer. Far outside: not seen.
    Planes inverse_depth;   // 1: expected there
    bool identity = false;  // both cameras are the same
};

// False: stopped.
bool find_motion(const Guides& now, const Guides& before, Motion& motion, RunContext& context);

// Rows of a history: what it holds of one component. The last one of a list is the age; 0 = nothing known.
struct HistoryView {
    const float* values;
    std::size_t pitch;
};

// Backward reprojection: of the four bilinear taps those that pass the tests, renormalised; if none does and
// the camera has moved the mean of those of the 3x3 pixels around that do; else 0 (disoccluded, with age 0).
// `to` has one component per view.
bool reproject(const Guides& now, const Guides& before, const Motion& motion, const SurfaceTests& tests,
               std::span<const HistoryView> from, Planes& to, RunContext& context);

}  // namespace tessera::filter::svgf
