#include "backends/embree/kernel.h"

namespace tessera::embree {

const Kernel& kernel_for(std::uint32_t features) {
    return (features & ~PlainKernel.features) == 0 ? PlainKernel : FullKernel;
}

}  // namespace tessera::embree
