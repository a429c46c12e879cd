#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// Upsamples a picture rendered at reduced size, guided by full-size features (joint bilateral upsampling,
// Kopf et al. 2007, on light without the surface's colour): for each pixel, the light of the 16 nearest small
// pixels, weighted by the similarity of normal, depth and albedo, times its own albedo. Where none is
// similar, or a full-size pixel has no sample, only the distance counts.
//   picture   small, 3 components or 4 with premultiplied alpha
//   small     its inputs, with Albedo, Normal, Depth; the size of `picture`
//   full      inputs of the full size with the same channels; with alpha also Alpha, which is copied
// `out` gets the full size and the components of the picture. False: stopped.
bool upsample(const Planes& picture, const Inputs& small, const Inputs& full, Planes& out,
              RunContext context);

}  // namespace tessera::filter
