#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// Averages a pixel with those neighbours whose mean radiance is statistically indistinguishable from its own,
// after Sakai et al., "A statistical approach to Monte Carlo denoising" (2024), from merged moments alone. q
// joins the average at p iff Welch's interval of the difference of the two means contains 0 in every channel
// (membership.h), with variances that are reliable at few samples (moderated_variance.h); this is symmetric
// in p and q. Members weigh n_q (samples are pooled) times Gaussians of the distance in the picture and of
// the differences of albedo, normal and the logarithm of depth. The paper's Box-Cox transform, which makes
// skewed samples nearly normal, needs the samples themselves and cannot be computed from merged moments. So
// fireflies, whose intervals are wide, are spread over their neighbours instead of being rejected.
FilterEntry statmc_entry();

}  // namespace tessera::filter
