// What most scenes are made of, and nothing else (kernel_text.h).
#define SHADING_KERNEL plain
#define SHADING_FEATURES PLAIN_FEATURES
#include "backends/embree/kernel_text.h"

namespace tessera::embree {

const Kernel PlainKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
