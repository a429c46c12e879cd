#pragma once

#include "master/filter/svgf/reproject.h"

namespace tessera::filter::svgf {

// Temporal antialiasing of a finished picture (E-D14, with its sign corrected): r c + (1 - r) clamp(p), where
// p is the previous picture at the nearest surface of the 3x3 neighbourhood, clamped to the range of those
// 3x3 pixels, and r the larger of `ratio` and the pixel's `newness` (fraction of its samples that the
// previous picture did not have). Blended in the range compression x / (1 + max(r, g, b)), whose inverse is
// exact because every colour keeps its divisor; linear radiance in and out; a fourth component is blended
// with the same weights. The result lies within the range of the 3x3 pixels. False: stopped.
bool antialias(const Planes& picture, const Planes& before, const Guides& now, const Motion& motion,
               const Planes& newness, float ratio, Planes& out, RunContext& context);

}  // namespace tessera::filter::svgf
