#pragma once

namespace tessera::vulkan {

// How kernels find hits.
enum class Traversal {
    Bvh2,     // binary BVHs, by address: the baseline of benchmarks
    Address,  // wide nodes by address
    Texels    // wide nodes as texels: faster, where the pool fits into a texel buffer
};

}  // namespace tessera::vulkan
