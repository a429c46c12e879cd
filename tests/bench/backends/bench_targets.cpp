#include "tests/bench/backends/bench_targets.h"

#include "tests/bench/backends/target_factories.h"

namespace tessera::bench {

std::vector<BenchTarget> bench_targets() {
    std::vector<BenchTarget> all;
#ifdef TESSERA_BACKEND_EMBREE
    all.push_back(embree_target());
#endif
#ifdef TESSERA_BACKEND_VULKAN
    all.push_back(vulkan_target());
    all.push_back(vulkan_plain_target());
#endif
    return all;
}

}  // namespace tessera::bench
