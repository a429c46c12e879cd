#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "backends/vulkan/bvh/mesh_bvh.h"
#include "backends/vulkan/bvh/top_bvh.h"
#include "mediator/shading/plain_trace.h"

namespace tessera::vulkan {

// The trees of plain_trace, the baseline; rows as those of WideTree.
struct PlainTree {
    std::vector<shading::PlainNode> nodes;
    std::vector<std::uint32_t> primitives;
};

// Throws Error{Internal} for a tree deeper than PlainDepth.
PlainTree build_plain_mesh(BinaryTreeBuilder& builder, const MeshData& mesh);
// The whole top level as it lies in the pool; boxes, places and rows of the instances are those of the plain
// trees.
std::vector<std::byte> build_plain_top(BinaryTreeBuilder& builder, std::span<const PlacedMesh> instances);

}  // namespace tessera::vulkan
