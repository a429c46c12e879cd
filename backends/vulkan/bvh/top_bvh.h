#pragma once

#include <span>
#include <vector>

#include "backends/vulkan/bvh/placed_mesh.h"
#include "backends/vulkan/bvh/wide_tree.h"

namespace tessera::vulkan {

// The top level: one row of nodes and instances as in shading/bvh_layout.h, each 80 bytes; then the places of
// what moves.
struct TopBvh {
    WideTree tree;
    std::vector<std::byte> row;
};

// What a visit to an instance costs before its root, in visits to a node. Measured on lavapipe: 1.6.
inline constexpr float InstanceCost = 2.0f;

// `instances` in the order of their numbers.
TopBvh build_top(BinaryTreeBuilder& builder, std::span<const PlacedMesh> instances);

// Instances have moved, or their meshes have other boxes or places: the tree stays. False: it is to be built
// anew, since an instance has come, gone or changed between being hit and left out (then it is as before), or
// since the tree has become bad (RefitLimit) or was never built.
bool refit_top(TopBvh& top, std::span<const PlacedMesh> instances, double built_cost);

}  // namespace tessera::vulkan
