#include "backends/embree/kernel.h"

#include <initializer_list>

namespace tessera::embree {

const Kernel& kernel_for(std::uint32_t features) {
    for (const Kernel* kernel : {&PlainKernel, &LightsKernel, &CoatedKernel, &GlassKernel, &FilmKernel,
                                 &ShaderKernel, &MovingKernel, &FoggyKernel}) {
        if ((features & ~kernel->features) == 0) return *kernel;
    }
    return FullKernel;
}

}  // namespace tessera::embree
