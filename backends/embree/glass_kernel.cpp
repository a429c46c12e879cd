// Frosted glass, and glass that has a colour by its thickness: often the same.
#define SHADING_KERNEL glass
#define SHADING_FEATURES \
    (PLAIN_FEATURES | shading::FeatureRoughGlass | shading::FeatureMedia | shading::FeatureNestedGlass)
#include "backends/embree/kernel_text.h"

namespace tessera::embree {

const Kernel GlassKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
