// Common features only (kernel_impl.h).
#define SHADING_KERNEL plain
#define SHADING_FEATURES PLAIN_FEATURES
#include "backends/embree/kernel_impl.h"

namespace tessera::embree {

const Kernel PlainKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
