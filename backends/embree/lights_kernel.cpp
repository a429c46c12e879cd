// Sphere and quad lights, and shadow catchers.
#define SHADING_KERNEL lights
#define SHADING_FEATURES (PLAIN_FEATURES | shading::FeatureAreaLights | shading::FeatureShadowCatcher)
#include "backends/embree/kernel_impl.h"

namespace tessera::embree {

const Kernel LightsKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
