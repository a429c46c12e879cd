#pragma once

#include "tests/bench/backends/bench_targets.h"

namespace tessera::bench {

BenchTarget embree_target();
BenchTarget vulkan_target();        // wide BVH
BenchTarget vulkan_plain_target();  // binary BVH, the baseline

}  // namespace tessera::bench
