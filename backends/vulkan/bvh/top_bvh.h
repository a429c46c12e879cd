#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "backends/vulkan/bvh/wide_tree.h"

namespace tessera::vulkan {

// One mesh placed in the world.
struct PlacedMesh {
    glm::mat3 linear{1.0f};  // world from object
    glm::vec3 translation{0.0f};
    Box box;                                 // WideTree::box of the mesh, in its own space
    std::uint32_t nodes = 0, triangles = 0;  // where the mesh's rows begin in the pool, in items
    bool alpha_tested = false;
};

// The top level: one row of nodes and instances as in shading/bvh_layout.h, each 80 bytes.
struct TopBvh {
    WideTree tree;
    std::vector<std::byte> row;
};

// An instance is left out and never hit when its mesh is empty, its transform has no inverse, or its box in
// the world goes beyond
// +-1.8e18. `instances` in the order of their numbers.
TopBvh build_top(BinaryTreeBuilder& builder, std::span<const PlacedMesh> instances,
                 const TraversalCosts& costs = {});

}  // namespace tessera::vulkan
