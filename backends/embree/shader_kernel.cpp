// X3D's CommonSurfaceShader, with area lights and shadow catchers.
#define SHADING_KERNEL shader
#define SHADING_FEATURES                                                           \
    (PLAIN_FEATURES | shading::FeatureSurfaceShader | shading::FeatureAreaLights | \
     shading::FeatureShadowCatcher)
#include "backends/embree/kernel_impl.h"

namespace tessera::embree {

const Kernel ShaderKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
