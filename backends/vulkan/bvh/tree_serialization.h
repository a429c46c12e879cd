#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "backends/vulkan/bvh/mesh_bvh.h"

namespace tessera::vulkan {

// A mesh BVH as bytes: its topology in visiting order, its primitives and its cost. No offsets are stored, so
// none can be wrong; boxes are recomputed from the mesh.
std::vector<std::byte> serialize_tree(const WideTree& tree);

// The same tree, bit for bit. Nothing for bytes that are not a valid tree of this mesh, even if crafted: the
// tree must be at most BvhMeshDepth deep, contain every valid triangle once, and have exactly the stored cost.
std::optional<WideTree> deserialize_tree(std::span<const std::byte> bytes, const MeshData& mesh,
                                         const TraversalCosts& costs = {});

}  // namespace tessera::vulkan
