// Soap and oil. A film is part of what every surface reflects: no other kernel is to have it.
#define SHADING_KERNEL film
#define SHADING_FEATURES (PLAIN_FEATURES | shading::FeatureExtras | shading::FeatureIridescence)
#include "backends/embree/kernel_text.h"

namespace tessera::embree {

const Kernel FilmKernel{SHADING_FEATURES, trace};

}  // namespace tessera::embree
