#define SHADING_HAS_ALL_FEATURES
#define SHADING_KERNEL studio
#define SHADING_FEATURES \
    (shading::FeatureMeshLights | shading::FeatureCoat | shading::FeatureExtras | shading::FeatureLightTree)
#include "backends/embree/kernel_impl.h"
#include "tests/bench/micro/exact_kernels.h"
namespace tessera::embree {

const Kernel StudioKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
