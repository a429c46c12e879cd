#pragma once

#include "master/filter/pixel/field.h"

// The filters that gather over the plane in one go. Like filter_separable: the result and its r are in
// `field`; a pixel that finds nothing keeps its values; false when stopped.
namespace tessera::filter::pixel {

// The cross-bilateral filter (Schwenk 3.6) over a square that is cut at 3 sigma: the reference, as slow as it
// is wide. r is exact.
bool filter_brute(const Guide& guide, const Widths& widths, Field& field, Field& scratch,
                  RunContext& context);

// Three edge-avoiding wavelet iterations (Dammertz 2010 with Schwenk's changes: the range buffer is the only
// guide, wider steps instead of five iterations). The 5x5 cubic B-spline of step 1 has variance 1, so steps
// are the sigmas of (Schwenk 3.14), rounded, narrowest first. `sigma` is one for the picture. r is the
// product over the iterations times what it lacks in flat regions, where iterations see correlated data; at
// most 1.
bool filter_atrous(const Guide& guide, float sigma, Field& field, Field& scratch, RunContext& context);

}  // namespace tessera::filter::pixel
