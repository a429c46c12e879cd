#define SHADING_KERNEL exact
#ifndef SHADING_FEATURES
#define SHADING_FEATURES 0x10021u
#endif
#include "backends/embree/kernel_text.h"

namespace tessera::embree {

extern const Kernel ExactKernel;
const Kernel ExactKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
