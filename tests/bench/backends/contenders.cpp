#include "tests/bench/backends/contenders.h"

#include "tests/bench/backends/parts.h"

namespace tessera::bench {

std::vector<Contender> contenders() {
    std::vector<Contender> all;
#ifdef TESSERA_BACKEND_EMBREE
    all.push_back(embree_contender());
#endif
#ifdef TESSERA_BACKEND_VULKAN
    all.push_back(vulkan_contender());
    all.push_back(vulkan_plain_contender());
#endif
    return all;
}

}  // namespace tessera::bench
