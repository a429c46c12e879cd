// Iridescence. It affects the Fresnel term of every surface, so no other kernel but the full one includes it.
#define SHADING_KERNEL film
#define SHADING_FEATURES (PLAIN_FEATURES | shading::FeatureExtras | shading::FeatureIridescence)
#include "backends/embree/kernel_impl.h"

namespace tessera::embree {

const Kernel FilmKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
