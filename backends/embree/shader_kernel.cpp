// X3D's surface, by lights with a shape or in a photograph as well.
#define SHADING_KERNEL shader
#define SHADING_FEATURES \
    (PLAIN_FEATURES | shading::FeatureShader | shading::FeatureShapedLights | shading::FeatureShadowCatcher)
#include "backends/embree/kernel_text.h"

namespace tessera::embree {

const Kernel ShaderKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
