#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// Progressive spatiotemporal variance-guided filter (Dundr 2): the irradiance of the first non-delta hit goes
// through a history and an edge-stopping wavelet transform, the rest is added. While the film goes on, the
// film itself is the history. When it restarts, what was known is reprojected and blended with the new film
// by E-D3, until the film outweighs it. Works from less than one sample per pixel on.
//
// Alpha stays as it was sampled: the weights of a hit and a miss, which have different ids, are 0, so no
// light is carried to where alpha differs but within the pixels of an outline, whose alpha is the mean of
// their samples.
//
// A run without any sample shows the picture before. Without its channels the picture is left as it is; the
// report says both.
FilterEntry psvgf_entry();

}  // namespace tessera::filter
