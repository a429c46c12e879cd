#define SHADING_HAS_ALL_FEATURES
#define SHADING_KERNEL still
#define SHADING_FEATURES                                                                 \
    (shading::FeatureTextures | shading::FeatureSpecular | shading::FeatureEnvironment | \
     shading::FeatureEnvironmentMap)
#include "backends/embree/kernel_impl.h"
#include "tests/bench/micro/exact_kernels.h"
namespace tessera::embree {

const Kernel StillKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
