// In one piece it would take three times as long to compile, and be no faster.
#define KERNEL_PIECES
#define SHADING_KERNEL full
#define SHADING_FEATURES 0xffffffffu
#include "backends/embree/kernel_text.h"

namespace tessera::embree {

const Kernel FullKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
