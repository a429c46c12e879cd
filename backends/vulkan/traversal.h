#pragma once

namespace tessera::vulkan {

// How kernels find hits.
enum class Traversal {
    Plain,    // trees of two children, by address: the baseline that benches measure
    Address,  // wide nodes by address
    Texels    // wide nodes as texels: faster, where the pool fits into a texel buffer
};

}  // namespace tessera::vulkan
