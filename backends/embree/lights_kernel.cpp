// Spheres and quads that shine, and what catches their shadows in a photograph.
#define SHADING_KERNEL lights
#define SHADING_FEATURES (PLAIN_FEATURES | shading::FeatureShapedLights | shading::FeatureShadowCatcher)
#include "backends/embree/kernel_text.h"

namespace tessera::embree {

const Kernel LightsKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
