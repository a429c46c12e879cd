#pragma once

#include <span>
#include <vector>

#include "backends/vulkan/bvh/placed_mesh.h"
#include "backends/vulkan/bvh/wide_tree.h"

namespace tessera::vulkan {

// The top level: one array of nodes and instances as in shading/bvh_layout.h, 80 bytes each, followed by the
// transforms of moving instances.
struct TopBvh {
    WideTree tree;
    std::vector<std::byte> row;
};

// The cost of entering an instance, relative to visiting a node. Measured on lavapipe: 1.6.
inline constexpr float InstanceCost = 2.0f;

// `instances` in the order of their numbers.
TopBvh build_top(BinaryTreeBuilder& builder, std::span<const PlacedMesh> instances);

// Refits the tree after instances moved or the boxes or offsets of their meshes changed. False: rebuild it,
// because instances were added, removed, or changed between valid and left out (the tree is unchanged then), or
// because the tree has become too expensive (RefitLimit) or was never built.
bool refit_top(TopBvh& top, std::span<const PlacedMesh> instances, double built_cost);

}  // namespace tessera::vulkan
