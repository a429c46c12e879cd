#pragma once

#include <cstdint>
#include <span>

#include "backends/vulkan/bvh/wide_tree.h"

namespace tessera::vulkan {

// Writes the shape of a wide tree, from the root down: each node is opened once, a parent before its children
// and all that is below one child before the next, so that the order of the visits alone says where
// everything stands.
class WideRows final {
  public:
    explicit WideRows(Level level);  // with the root, at 0, to be opened

    // Makes room for the inner children of the node at `at`, which is `depth` levels down (the root is 1);
    // they follow each other from the place that is returned.
    std::uint32_t open_node(std::uint32_t at, std::uint32_t depth, std::uint32_t inner_count);
    // A child of the node that was opened last: 1 to BvhLeafTriangles primitives, or one instance. Slots from
    // the count of inner children on, in order.
    void add_leaf(std::uint32_t at, std::uint32_t slot, std::span<const std::uint32_t> primitives);

    WideTree take() { return std::move(tree_); }

  private:
    Level level_;
    WideTree tree_;
};

}  // namespace tessera::vulkan
