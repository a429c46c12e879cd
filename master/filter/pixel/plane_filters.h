#pragma once

#include "master/filter/pixel/field.h"

// Non-separable filters. As in filter_separable, the result and its r are in `field`, pixels without similar
// neighbours keep their values, and false means stopped.
namespace tessera::filter::pixel {

// The cross-bilateral filter (Schwenk 3.6) over a square that is cut at 3 sigma: the reference; its time
// grows with the square of the width. r is exact.
bool filter_brute_force(const Guide& guide, const Widths& widths, Field& field, Field& scratch,
                        RunContext& context);

// Three edge-avoiding wavelet iterations (Dammertz 2010 with Schwenk's changes: the headlight feature is the
// only guide, wider steps instead of five iterations). The 5x5 cubic B-spline of step 1 has variance 1, so
// steps are the sigmas of (Schwenk 3.14), rounded, narrowest first. `sigma` is one for the picture. r is the
// product over the iterations times a correction for flat regions, where iterations filter correlated data;
// at most 1.
bool filter_atrous(const Guide& guide, float sigma, Field& field, Field& scratch, RunContext& context);

}  // namespace tessera::filter::pixel
