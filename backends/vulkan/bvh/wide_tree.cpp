#include "backends/vulkan/bvh/wide_tree.h"

#include <algorithm>
#include <array>

#include "backends/vulkan/bvh/wide_tree_writer.h"

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

// Follows the decisions of the dynamic programme: `node` as at most `max_children` children.
void spread(const BinaryNode& node, std::uint32_t max_children, Children& out) {
    if (node.count == 1) return out.add(node, true);
    const InnerNode& inner = as_inner(node);
    max_children = std::min(max_children, InnerNode::MaxChildren);
    while (max_children > 1 && inner.left_children[max_children - 1] == 0) --max_children;
    if (max_children == 1) return out.add(node, inner.leaf);
    const std::uint32_t left = inner.left_children[max_children - 1];
    spread(*inner.left, left, out);
    spread(*inner.right, max_children - left, out);
}

Children cheapest_children(const BinaryNode& node) {
    Children out;
    if (node.count == 1 || as_inner(node).leaf) {
        out.add(node, true);
        return out;
    }
    const InnerNode& inner = as_inner(node);
    spread(*inner.left, inner.wide_left_children, out);
    spread(*inner.right, BvhWidth - inner.wide_left_children, out);
    return out;
}

// All primitives of the subtree.
void gather(const BinaryNode& node, std::vector<std::uint32_t>& out) {
    if (node.count == 1) return out.push_back(node.primitive);
    gather(*as_inner(node).left, out);
    gather(*as_inner(node).right, out);
}

class Collapse {
  public:
    Collapse(Level level, std::uint32_t max_depth) : level_(level), max_depth_(max_depth), rows_(level) {}

    WideTree run(const BinaryNode* root) {
        if (root == nullptr) {
            rows_.open_node(0, 1, 0);
        } else if (!place(*root, 0, 1)) {
            rows_ = WideTreeWriter(level_);
            std::vector<std::uint32_t> all;
            gather(*root, all);
            divide_evenly(all, 0, 1);
        }
        return rows_.take();
    }

  private:
    // False: too deep.
    bool place(const BinaryNode& node, std::uint32_t at, std::uint32_t depth) {
        if (depth > max_depth_) return false;
        Children children = cheapest_children(node);
        const auto end = children.items.begin() + children.count;
        const auto leaves = std::stable_partition(children.items.begin(), end,
                                                  [](const Child& child) { return !child.leaf; });
        const auto inner_count = static_cast<std::uint32_t>(leaves - children.items.begin());
        const std::uint32_t first = rows_.open_node(at, depth, inner_count);
        for (std::uint32_t slot = inner_count; slot < children.count; ++slot) {
            gathered_.clear();
            gather(*children.items[slot].node, gathered_);
            rows_.add_leaf(at, slot, gathered_);
        }
        for (std::uint32_t slot = 0; slot < inner_count; ++slot) {
            if (!place(*children.items[slot].node, first + slot, depth + 1)) return false;
        }
        return true;
    }

    // Halves of the row of primitives, as deep as their logarithm.
    void divide_evenly(std::span<const std::uint32_t> part, std::uint32_t at, std::uint32_t depth) {
        const std::size_t fit = level_ == Level::Mesh ? shading::BvhLeafTriangles : 1;
        const bool last = part.size() <= BvhWidth * fit;
        const std::size_t pieces = last ? (part.size() + fit - 1) / fit : BvhWidth;
        const auto piece = [&](std::size_t i) {
            const std::size_t begin = part.size() * i / pieces;
            return part.subspan(begin, part.size() * (i + 1) / pieces - begin);
        };
        const std::uint32_t first = rows_.open_node(at, depth, last ? 0 : BvhWidth);
        for (std::uint32_t i = 0; i < pieces; ++i) {
            if (last) {
                rows_.add_leaf(at, i, piece(i));
            } else {
                divide_evenly(piece(i), first + i, depth + 1);
            }
        }
    }

    Level level_;
    std::uint32_t max_depth_;
    WideTreeWriter rows_;
    std::vector<std::uint32_t> gathered_;
};

}  // namespace

WideTree collapse(const BinaryNode* root, Level level, std::uint32_t max_depth) {
    return Collapse(level, max_depth).run(root);
}

}  // namespace tessera::vulkan
