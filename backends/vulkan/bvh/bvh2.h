#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "backends/vulkan/bvh/mesh_bvh.h"
#include "backends/vulkan/bvh/top_bvh.h"
#include "mediator/shading/bvh2_trace.h"

namespace tessera::vulkan {

// A binary BVH for bvh2_trace, the baseline; arrays as in WideTree.
struct Bvh2 {
    std::vector<shading::Bvh2Node> nodes;
    std::vector<std::uint32_t> primitives;
};

// Throws Error{Internal} for a tree deeper than Bvh2MaxDepth.
Bvh2 build_bvh2_mesh(BinaryTreeBuilder& builder, const MeshData& mesh);
// The whole top level as stored in the pool; boxes and offsets of the instances are those of the binary BVHs.
std::vector<std::byte> build_bvh2_top(BinaryTreeBuilder& builder, std::span<const PlacedMesh> instances);

}  // namespace tessera::vulkan
