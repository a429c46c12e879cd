#define SHADING_KERNEL plain
#define SHADING_FEATURES                                                                        \
    (shading::FeatureTextures | shading::FeatureNormalMaps | shading::FeatureAlpha |            \
     shading::FeatureSpecular | shading::FeaturePlacedLights | shading::FeatureMeshLights |     \
     shading::FeatureEnvironment | shading::FeatureEnvironmentMap | shading::FeatureLightTree | \
     shading::FeatureSuns)
#include "backends/embree/kernel_text.h"

namespace tessera::embree {

const Kernel PlainKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
