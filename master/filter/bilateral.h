#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// Cross-bilateral filter (Eisemann and Durand 2004; Petschnigg et al. 2004): means with the weights
//     g(|p - q|, sigma) g(albedo) g(normal) g(ln depth),   g(t, s) = exp(-t^2 / (2 s^2))
// over a square cut at 2.5 sigma. Weights do not depend on the colour, so detail that no feature shows (e.g.
// a shadow) is blurred.
FilterEntry bilateral_entry();

}  // namespace tessera::filter
