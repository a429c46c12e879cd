#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// Averages a pixel with those neighbours whose light is statistically indistinguishable from its own, after Sakai et al.,
// "A statistical approach to Monte Carlo denoising" (2024), from merged moments alone. q joins the average at p iff Welch's
// interval of the difference of two means contains 0 in every channel (membership.h), with variances that are reliable at
// few samples (moderated_variance.h); this is symmetric in p and q. The means that are compared are those of the Box-Cox
// transform 2 (sqrt(L) - 1) of each sample (the channel root), which is nearer to a normal distribution than the
// radiance L; what is averaged is the radiance. Members weigh n_q (samples are pooled) times Gaussians of the distance in
// the picture and of the differences of albedo, normal and the logarithm of depth.
//
// Not as in the paper: the window is a square of radius 10 with a deviation of 5 pixels, for speed (a disc of radius 20 and
// 10); depth is compared, too; the variance of a pixel is moderated by that of its neighbours; features of few samples are
// not taken for exact (feature_noise); Johnson's correction for skewness, which needs third moments, is left out.
//
// A pixel of which one sample of few is bright has a wide interval, transformed or not: fireflies are spread over their
// neighbours instead of being rejected.
//
// relMSE over unfiltered, geometric mean (without the worst 0.1 % of the pixels) over cornell, grids, caustics, studio-1 and
// room-1, 128 x 72, at 4, 16, 64 and 256 samples:
//
//     means of radiance, features exact     0.324 (0.361)
//     feature_noise 2                       0.302 (0.361)
//     and transform root                    0.286 (0.331)
FilterEntry statmc_entry();

}  // namespace tessera::filter
