// All features. Not flattened: it would take three times as long to compile without being faster.
#define KERNEL_INLINING
#define SHADING_KERNEL full
#define SHADING_FEATURES 0xffffffffu
#include "backends/embree/kernel_impl.h"

namespace tessera::embree {

const Kernel FullKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
