#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// NL-means of the colour (Buades et al. 2005; Rousselle et al. 2012 for known variances) at several scales:
// each level is half of the one before, all are filtered alike, and from the coarsest on a level's low
// frequencies are replaced by those of the coarser one, which removes low-frequency noise (Lardinoije 2.1):
//     out_s += up(out_(s+1) - down(out_s))
// Does not use surface features, except for demodulation by albedo.
FilterEntry nlm_entry();

}  // namespace tessera::filter
