#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "backends/vulkan/bvh/wide_tree.h"

namespace tessera::vulkan {

struct MeshData {
    std::span<const glm::vec3> positions;
    std::span<const glm::uvec3> triangles;  // their indices are within `positions`
    std::vector<std::span<const glm::vec3>>
        steps{};  // where the positions are at steps of time after the first
};

// Boxes of the triangles that can be hit, at all times. Left out are those without area at any step, or with
// a coordinate that is no number or beyond +-1.8e18 (where Embree stops, too).
struct MeshBoxes {
    std::vector<Box> boxes;
    std::vector<std::uint32_t> triangles;
};
MeshBoxes boxes_of(const MeshData& mesh);

// The bottom level of one mesh.
WideTree build_mesh(BinaryTreeBuilder& builder, const MeshData& mesh, const TraversalCosts& costs = {});

// Same triangles, other positions: the tree stays, its boxes follow. False: a triangle that was left out has
// an area now, or the tree has become bad, see RefitLimit; then it is to be built anew (its boxes are right
// in the second case). `built_cost`: WideTree::cost after the last build.
bool refit_mesh(WideTree& tree, const MeshData& mesh, double built_cost, const TraversalCosts& costs = {});

// The row of triangles: WideTree::primitives of the mesh; `out` has as many, for each step of time.
void write_triangles(std::span<const std::uint32_t> primitives, const MeshData& mesh,
                     std::span<shading::BvhTriangle> out);

}  // namespace tessera::vulkan
