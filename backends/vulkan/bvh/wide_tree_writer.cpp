#include "backends/vulkan/bvh/wide_tree_writer.h"

#include <algorithm>

namespace tessera::vulkan {

using shading::BvhNode;

WideTreeWriter::WideTreeWriter(Level level) : level_(level) {
    tree_.nodes.resize(1);
    tree_.depth = 1;
    if (level_ == Level::Top) tree_.primitives.assign(1, WideTree::NoPrimitive);
}

std::uint32_t WideTreeWriter::open_node(std::uint32_t at, std::uint32_t depth, std::uint32_t inner_count) {
    tree_.depth = std::max(tree_.depth, depth);
    const auto first = static_cast<std::uint32_t>(tree_.nodes.size());
    tree_.nodes.resize(first + inner_count);
    if (level_ == Level::Top) tree_.primitives.resize(tree_.nodes.size(), WideTree::NoPrimitive);
    BvhNode& node = tree_.nodes[at];
    node.frame = inner_count << 24u;
    node.first_child = first;
    node.first_triangle = level_ == Level::Mesh ? static_cast<std::uint32_t>(tree_.primitives.size()) : 0;
    return first;
}

void WideTreeWriter::add_leaf(std::uint32_t at, std::uint32_t slot,
                              std::span<const std::uint32_t> primitives) {
    if (level_ == Level::Mesh) {
        BvhNode& node = tree_.nodes[at];
        const auto offset = static_cast<std::uint32_t>(tree_.primitives.size()) - node.first_triangle;
        const std::uint32_t byte = ((1u << primitives.size()) - 1u) << 5u | offset;
        node.leaves[slot / 4] |= byte << (8u * (slot % 4));
    } else {
        tree_.nodes.emplace_back();
        ++tree_.nodes[at].first_triangle;
    }
    tree_.primitives.insert(tree_.primitives.end(), primitives.begin(), primitives.end());
}

}  // namespace tessera::vulkan
