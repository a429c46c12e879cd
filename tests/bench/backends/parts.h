#pragma once

#include "tests/bench/backends/contenders.h"

namespace tessera::bench {

Contender embree_contender();
Contender vulkan_contender();        // wide nodes
Contender vulkan_plain_contender();  // trees of two children, the baseline

}  // namespace tessera::bench
