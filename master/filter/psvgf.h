#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// Progressive spatiotemporal variance-guided filter (Dundr 2): the irradiance of the first non-delta hit goes
// through a history and an edge-stopping wavelet transform, the rest is added. While the film grows, it is
// the history itself. When it restarts, the previous result is reprojected and blended with the new film by
// E-D3, until the film outweighs it. Works with less than one sample per pixel.
// Alpha is not filtered: weights between hits and misses, which have different ids, are 0, so no light
// crosses an outline except within its pixels, whose alpha is the mean of their samples. A run without
// samples returns the previous picture. Without its channels the picture is not filtered. The report notes
// both.
FilterEntry psvgf_entry();

}  // namespace tessera::filter
