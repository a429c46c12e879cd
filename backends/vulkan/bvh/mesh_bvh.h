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
        later_positions{};  // positions at the motion keys after the first
};

// Boxes of all valid triangles over the whole motion. Triangles with zero area at any key, or with a coordinate
// that is not a number or beyond +-1.8e18 (Embree's limit as well), are left out.
struct MeshBoxes {
    std::vector<Box> boxes;
    std::vector<std::uint32_t> triangles;
};
MeshBoxes boxes_of(const MeshData& mesh);

// The bottom level of one mesh.
WideTree build_mesh(BinaryTreeBuilder& builder, const MeshData& mesh, const TraversalCosts& costs = {});

// Refits the boxes to new positions of the same triangles. False: rebuild the tree, because a triangle that was
// left out has an area now, or because the tree has become too expensive (see RefitLimit; its boxes are correct
// then). `built_cost`: WideTree::cost after the last build.
bool refit_mesh(WideTree& tree, const MeshData& mesh, double built_cost, const TraversalCosts& costs = {});

// Triangles in the order of WideTree::primitives; `out` has as many for each motion key.
void write_triangles(std::span<const std::uint32_t> primitives, const MeshData& mesh,
                     std::span<shading::BvhTriangle> out);

}  // namespace tessera::vulkan
