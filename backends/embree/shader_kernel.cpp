// X3D: its surface, lights with a shape and what takes part in a photograph.
#define SHADING_KERNEL shader
#define SHADING_FEATURES \
    (PLAIN_FEATURES | shading::FeatureShader | shading::FeatureShapedLights | shading::FeatureShadowCatcher)
#include "backends/embree/kernel_text.h"

namespace tessera::embree {

const Kernel ShaderKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
