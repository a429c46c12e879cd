#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// NL-means of the colour (Buades et al. 2005; Rousselle et al. 2012 for known variances) at several scales:
// each level is half of the one before, all are filtered alike, and from the coarsest on a level's low
// frequencies become those of the coarser one, which is how noise of low frequency goes (Lardinoije 2.1):
//     out_s += up(out_(s+1) - down(out_s))
// Knows nothing of surfaces unless the albedo is divided out.
FilterEntry nlm_entry();

}  // namespace tessera::filter
