#pragma once

#include <span>

#include "master/filter/svgf/guides.h"

namespace tessera::filter::svgf {

// Tests whether a pixel of the previous picture shows the same surface (Dundr 2.2, defaults of SVGF).
struct SurfaceTests {
    float depth_slopes = 10.0f;   // tolerance of inverse depth in slopes per pixel ...
    float depth = 0.01f;          // ... plus this fraction of itself (published: 0.01 scene units)
    float normal_slopes = 16.0f;  // |n - n'| <= normal_slopes (change of n per pixel + 0.01)
};

// Where every pixel's surface point was in the previous picture, for static surfaces.
struct Motion {
    Planes position;        // 2: x, y; a pixel's centre is its integer. Far outside: not visible.
    Planes inverse_depth;   // 1: expected at that position
    bool identity = false;  // both cameras are the same
    bool still = false;     // and nothing else has changed: every pixel has the same expected value
};

// False: stopped.
bool find_motion(const Guides& now, const Guides& before, Motion& motion, RunContext& context);

// One component of a history. The last one of a list is the age; 0 = no history.
struct HistoryView {
    const float* values;
    std::size_t pitch;
};

// Backward reprojection: the bilinear taps that pass the tests, renormalised; if none does and the camera has
// moved, the mean of the surrounding 3x3 pixels that do; else 0 (disoccluded, with age 0). `to` has one
// component per view. In a still picture the same pixel is taken, whose samples may see several surfaces, if its surface
// is among those of the 3x3 pixels in the other picture, both ways; otherwise the view differs in what it shows.
bool reproject(const Guides& now, const Guides& before, const Motion& motion, const SurfaceTests& tests,
               std::span<const HistoryView> from, Planes& to, RunContext& context);

}  // namespace tessera::filter::svgf
