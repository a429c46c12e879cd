// Motion while the shutter is open.
#define SHADING_KERNEL moving
#define SHADING_FEATURES (PLAIN_FEATURES | shading::FeatureMotion | shading::FeatureCameraMotion)
#include "backends/embree/kernel_impl.h"

namespace tessera::embree {

const Kernel MovingKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
