#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// Cross-bilateral filter (Eisemann and Durand 2004; Petschnigg et al. 2004): means with the weights
//     g(|p - q|, sigma) g(albedo) g(normal) g(ln depth),   g(t, s) = exp(-t^2 / (2 s^2))
// over a square cut at 2.5 sigma. The colour has no say, so what no feature shows, as a shadow, is blurred.
FilterEntry bilateral_entry();

}  // namespace tessera::filter
