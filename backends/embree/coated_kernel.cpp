// Layers over a surface (coat, sheen) and anisotropy: cars, wood, cloth.
#define SHADING_KERNEL coated
#define SHADING_FEATURES \
    (PLAIN_FEATURES | shading::FeatureExtras | shading::FeatureCoat | shading::FeatureSheen)
#include "backends/embree/kernel_impl.h"

namespace tessera::embree {

const Kernel CoatedKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
