#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "backends/vulkan/bvh/wide_tree.h"

namespace tessera::vulkan {

struct MeshData {
    std::span<const glm::vec3> positions;
    std::span<const glm::uvec3> triangles;  // their indices are within `positions`
};

// The bottom level of one mesh: WideTree over its triangles. Those without area, or with a coordinate that is
// no number or beyond +-1.8e18 (where Embree stops, too), are left out and never hit.
WideTree build_mesh(BinaryTreeBuilder& builder, const MeshData& mesh, const TraversalCosts& costs = {});

// Same triangles, other positions: the tree stays, its boxes follow. False: a triangle that was left out has
// an area now, or the tree has become bad, see RefitLimit; then it is to be built anew (its boxes are right
// in the second case). `built_cost`: WideTree::cost after the last build.
bool refit_mesh(WideTree& tree, const MeshData& mesh, double built_cost, const TraversalCosts& costs = {});

// A refitted tree may cost so many times what it cost when it was built.
inline constexpr double RefitLimit = 1.5;

// The row of triangles, `out` of tree.primitives.size().
void write_triangles(const WideTree& tree, const MeshData& mesh, std::span<shading::BvhTriangle> out);

}  // namespace tessera::vulkan
