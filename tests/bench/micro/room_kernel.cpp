#define SHADING_HAS_ALL_FEATURES
#define SHADING_KERNEL room
#define SHADING_FEATURES (shading::FeatureTextures | shading::FeatureMeshLights | shading::FeatureLightTree)
#include "backends/embree/kernel_impl.h"
#include "tests/bench/micro/exact_kernels.h"
namespace tessera::embree {

const Kernel RoomKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
