#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// A picture of full size from one that was rendered smaller and from full-size features (joint bilateral
// upsampling, Kopf et al. 2007, on light without the surface's colour): for each pixel, the light of the 16
// nearest small pixels whose normal, depth and albedo are like its own, times its own albedo. Where none is
// alike, or a full pixel has no sample, all count by distance.
//   picture   small, 3 components or 4 with premultiplied alpha
//   small     its inputs, with Albedo, Normal, Depth; the size of `picture`
//   full      inputs of the full size with the same channels; with alpha also Alpha, which is taken from here
// `out` gets the full size and the components of the picture. False: stopped.
bool upsample(const Planes& picture, const Inputs& small, const Inputs& full, Planes& out,
              RunContext context);

}  // namespace tessera::filter
