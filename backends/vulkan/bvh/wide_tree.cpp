#include "backends/vulkan/bvh/wide_tree.h"

#include <algorithm>
#include <array>

namespace tessera::vulkan {

namespace {

using shading::BvhNode;
using shading::BvhWidth;

struct Child {
    const BinaryNode* node = nullptr;
    bool leaf = false;
};

struct Children {
    std::array<Child, BvhWidth> items;
    std::uint32_t count = 0;
    void add(const BinaryNode& node, bool leaf) { items[count++] = {&node, leaf}; }
};

// Follows the decisions of the dynamic programme: `node` as at most `ways` children.
void spread(const BinaryNode& node, std::uint32_t ways, Children& out) {
    if (node.count == 1) return out.add(node, true);
    const InnerNode& inner = as_inner(node);
    ways = std::min(ways, InnerNode::Ways);
    while (ways > 1 && inner.left_share[ways - 1] == 0) --ways;
    if (ways == 1) return out.add(node, inner.leaf);
    const std::uint32_t left = inner.left_share[ways - 1];
    spread(*inner.left, left, out);
    spread(*inner.right, ways - left, out);
}

Children cheapest_children(const BinaryNode& node) {
    Children out;
    if (node.count == 1 || as_inner(node).leaf) {
        out.add(node, true);
        return out;
    }
    const InnerNode& inner = as_inner(node);
    spread(*inner.left, inner.wide_left_share, out);
    spread(*inner.right, BvhWidth - inner.wide_left_share, out);
    return out;
}

void gather(const BinaryNode& node, std::vector<const BinaryNode*>& out) {
    if (node.count == 1) return out.push_back(&node);
    gather(*as_inner(node).left, out);
    gather(*as_inner(node).right, out);
}

class Collapse {
  public:
    Collapse(Level level, std::uint32_t max_depth) : level_(level), max_depth_(max_depth) {}

    WideTree run(const BinaryNode* root) {
        tree_.nodes.resize(1);
        tree_.depth = 1;
        if (level_ == Level::Top) tree_.primitives.assign(1, WideTree::NoPrimitive);
        if (root != nullptr && !place(*root, 0, 1)) {
            tree_ = {};
            place_evenly(*root);
        }
        return std::move(tree_);
    }

  private:
    // False: too deep.
    bool place(const BinaryNode& node, std::uint32_t at, std::uint32_t depth) {
        if (depth > max_depth_) return false;
        tree_.depth = std::max(tree_.depth, depth);
        Children children = cheapest_children(node);
        const auto end = children.items.begin() + children.count;
        const auto leaves = std::stable_partition(children.items.begin(), end,
                                                  [](const Child& child) { return !child.leaf; });
        const auto inner_count = static_cast<std::uint32_t>(leaves - children.items.begin());
        const std::uint32_t first = open_node(at, inner_count);
        for (std::uint32_t slot = inner_count; slot < children.count; ++slot) {
            gathered_.clear();
            gather(*children.items[slot].node, gathered_);
            add_leaf(at, slot, gathered_);
        }
        for (std::uint32_t slot = 0; slot < inner_count; ++slot) {
            if (!place(*children.items[slot].node, first + slot, depth + 1)) return false;
        }
        return true;
    }

    // Halves of the row of primitives, as deep as their logarithm.
    void place_evenly(const BinaryNode& root) {
        tree_.nodes.resize(1);
        if (level_ == Level::Top) tree_.primitives.assign(1, WideTree::NoPrimitive);
        std::vector<const BinaryNode*> all;
        gather(root, all);
        divide_evenly(all, 0, 1);
    }

    void divide_evenly(std::span<const BinaryNode* const> part, std::uint32_t at, std::uint32_t depth) {
        tree_.depth = std::max(tree_.depth, depth);
        const std::size_t fit = level_ == Level::Mesh ? shading::BvhLeafTriangles : 1;
        const bool last = part.size() <= BvhWidth * fit;
        const std::size_t pieces = last ? (part.size() + fit - 1) / fit : BvhWidth;
        const auto piece = [&](std::size_t i) {
            const std::size_t begin = part.size() * i / pieces;
            return part.subspan(begin, part.size() * (i + 1) / pieces - begin);
        };
        const std::uint32_t first = open_node(at, last ? 0 : BvhWidth);
        for (std::uint32_t i = 0; i < pieces; ++i) {
            if (last) {
                add_leaf(at, i, piece(i));
            } else {
                divide_evenly(piece(i), first + i, depth + 1);
            }
        }
    }

    std::uint32_t open_node(std::uint32_t at, std::uint32_t inner_count) {
        const auto first = static_cast<std::uint32_t>(tree_.nodes.size());
        tree_.nodes.resize(first + inner_count);
        if (level_ == Level::Top) tree_.primitives.resize(tree_.nodes.size(), WideTree::NoPrimitive);
        BvhNode& node = tree_.nodes[at];
        node.frame = inner_count << 24u;
        node.first_child = first;
        node.first_triangle = level_ == Level::Mesh ? static_cast<std::uint32_t>(tree_.primitives.size()) : 0;
        return first;
    }

    void add_leaf(std::uint32_t at, std::uint32_t slot, std::span<const BinaryNode* const> primitives) {
        if (level_ == Level::Mesh) {
            BvhNode& node = tree_.nodes[at];
            const auto offset = static_cast<std::uint32_t>(tree_.primitives.size()) - node.first_triangle;
            const std::uint32_t byte = ((1u << primitives.size()) - 1u) << 5u | offset;
            node.leaves[slot / 4] |= byte << (8u * (slot % 4));
        } else {
            tree_.nodes.emplace_back();
            ++tree_.nodes[at].first_triangle;
        }
        for (const BinaryNode* leaf : primitives) tree_.primitives.push_back(leaf->primitive);
    }

    Level level_;
    std::uint32_t max_depth_;
    WideTree tree_;
    std::vector<const BinaryNode*> gathered_;
};

}  // namespace

WideTree collapse(const BinaryNode* root, Level level, std::uint32_t max_depth) {
    return Collapse(level, max_depth).run(root);
}

}  // namespace tessera::vulkan
