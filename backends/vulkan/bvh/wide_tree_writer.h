#pragma once

#include <cstdint>
#include <span>

#include "backends/vulkan/bvh/wide_tree.h"

namespace tessera::vulkan {

// Writes the topology of a wide tree in depth-first order: each node is opened once, parents before children,
// so that the visiting order alone determines all offsets.
class WideTreeWriter final {
  public:
    explicit WideTreeWriter(Level level);  // has an unopened root at index 0

    // Allocates the inner children of the node at `at`, which has depth `depth` (the root has 1). They are
    // contiguous, starting at the returned index.
    std::uint32_t open_node(std::uint32_t at, std::uint32_t depth, std::uint32_t inner_count);
    // Adds a leaf to the node opened last: 1 to BvhLeafTriangles primitives, or one instance. Slots follow those
    // of the inner children, in order.
    void add_leaf(std::uint32_t at, std::uint32_t slot, std::span<const std::uint32_t> primitives);

    WideTree take() { return std::move(tree_); }

  private:
    Level level_;
    WideTree tree_;
};

}  // namespace tessera::vulkan
