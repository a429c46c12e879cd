#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// Nonlinearly weighted first-order regression (Bitterli et al. 2016, "Nonlinearly weighted first-order
// regression for denoising Monte Carlo renderings"): the light around a pixel is fitted as a linear function
// of prefiltered features and of the position, with NL-means weights on colour. Each half of the samples is
// filtered with weights from the other; two bandwidths, and a map of which has less error. A second pass fits the
// mean of both, with patches of 3 x 3 pixels and the noise that their difference shows. Variances are those of
// moderated_variance.h. Slow, with high quality: the reference among filters without training.
FilterEntry nfor_entry();

}  // namespace tessera::filter
