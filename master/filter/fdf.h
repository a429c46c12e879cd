#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// Feature distance filter (Lardinoije 4.2): a cross-bilateral mean of the colour, guided by albedo, mapped
// normal and the light that paths found (shading feature), which is prefiltered by NL-means (fdf/nl_means.h,
// fdf/feature_bilateral.h). Weights do not depend on the colour. Blends back to the samples where it would
// worsen a converged picture (convergence_blend.h).
//
// E-L3: the variance of the shading feature is that of its mean, M2 / (n (n - 1)) per pixel. With n = 1 it is
// unknown and the variance between the pixels of the 5 x 5 neighbourhood is used instead.
//
// The shading feature is divided by its mean over the surfaces of the picture, because s_max assumes light of
// order 1.
FilterEntry fdf_entry();

}  // namespace tessera::filter
