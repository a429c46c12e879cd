// Panes, rough glass and absorbing glass, which often occur together.
#define SHADING_KERNEL glass
#define SHADING_FEATURES                                                                               \
    (PLAIN_FEATURES | shading::FeatureThinGlass | shading::FeatureRoughGlass | shading::FeatureMedia | \
     shading::FeatureNestedGlass)
#include "backends/embree/kernel_impl.h"

namespace tessera::embree {

const Kernel GlassKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
