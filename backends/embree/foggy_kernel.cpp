// Fog, smoke and clouds: rays that stop between surfaces, and look for light through open boundaries.
#define SHADING_KERNEL foggy
#define SHADING_FEATURES                                                                               \
    (PLAIN_FEATURES | shading::FeatureMedia | shading::FeatureOpenMedia | shading::FeatureScattering | \
     shading::FeatureMediaTextures)
#include "backends/embree/kernel_text.h"

namespace tessera::embree {

const Kernel FoggyKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
