// What lies over a surface: cars, wood, cloth. Extras tell of it, and of anisotropy.
#define SHADING_KERNEL coated
#define SHADING_FEATURES \
    (PLAIN_FEATURES | shading::FeatureExtras | shading::FeatureCoat | shading::FeatureSheen)
#include "backends/embree/kernel_text.h"

namespace tessera::embree {

const Kernel CoatedKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
