// Fog, smoke and clouds: scattering between surfaces, and shadow rays through index-matched boundaries.
#define SHADING_KERNEL foggy
#define SHADING_FEATURES                                                          \
    (PLAIN_FEATURES | shading::FeatureMedia | shading::FeatureIndexMatchedMedia | \
     shading::FeatureScattering | shading::FeatureMediaTextures)
#include "backends/embree/kernel_impl.h"

namespace tessera::embree {

const Kernel FoggyKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
