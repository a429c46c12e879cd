#include "backends/vulkan/bvh/bvh2.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "backends/vulkan/bvh/quantise.h"
#include "mediator/base/error.h"

namespace tessera::vulkan {

namespace {

using shading::Bvh2Leaf;
using shading::Bvh2Node;

class Flatten {
  public:
    explicit Flatten(Level level) : level_(level) {}

    Bvh2 run(const BinaryNode* root) {
        tree_.nodes.push_back({.child0 = shading::Bvh2None, .child1 = shading::Bvh2None});
        if (root == nullptr) {
            return std::move(tree_);
        }
        if (is_leaf(*root)) {
            set_child(0, 0, add_leaf(*root), root->box);
        } else {
            fill(as_inner(*root), 0, 1);
        }
        return std::move(tree_);
    }

  private:
    bool is_leaf(const BinaryNode& node) const { return node.count == 1 || as_inner(node).leaf; }

    void fill(const InnerNode& node, std::uint32_t at, std::uint32_t depth) {
        if (depth > shading::Bvh2MaxDepth) {
            throw Error(ErrorCode::Internal, "the binary BVH is too deep: use the wide BVH");
        }
        const std::array<const BinaryNode*, 2> children{node.left, node.right};
        for (std::uint32_t i = 0; i < 2; ++i) {
            if (is_leaf(*children[i])) {
                set_child(at, i, add_leaf(*children[i]), children[i]->box);
                continue;
            }
            const auto place = static_cast<std::uint32_t>(tree_.nodes.size());
            tree_.nodes.emplace_back();
            set_child(at, i, place, children[i]->box);
            fill(as_inner(*children[i]), place, depth + 1);
        }
    }

    std::uint32_t add_leaf(const BinaryNode& node) {
        const auto first = static_cast<std::uint32_t>(tree_.primitives.size());
        add_primitives(node);
        return Bvh2Leaf | (level_ == Level::Top ? first : first << 2u | node.count);
    }

    void add_primitives(const BinaryNode& node) {
        if (node.count == 1) return tree_.primitives.push_back(node.primitive);
        add_primitives(*as_inner(node).left);
        add_primitives(*as_inner(node).right);
    }

    // Includes the margin for rounding in the triangle test (quantise.h).
    void set_child(std::uint32_t at, std::uint32_t child, std::uint32_t value, const Box& box) {
        Bvh2Node& node = tree_.nodes[at];
        const glm::vec3 size = box.high - box.low;
        const float margin = static_cast<float>(MarginOfExtent) * std::max({size.x, size.y, size.z});
        (child == 0 ? node.child0 : node.child1) = value;
        (child == 0 ? node.low0 : node.low1) = box.low - margin;
        (child == 0 ? node.high0 : node.high1) = box.high + margin;
    }

    Level level_;
    Bvh2 tree_;
};

}  // namespace

Bvh2 build_bvh2_mesh(BinaryTreeBuilder& builder, const MeshData& mesh) {
    const MeshBoxes boxes = boxes_of(mesh);
    Bvh2 tree = Flatten(Level::Mesh).run(builder.build(boxes.boxes, {}));
    for (std::uint32_t& primitive : tree.primitives) primitive = boxes.triangles[primitive];
    return tree;
}

std::vector<std::byte> build_bvh2_top(BinaryTreeBuilder& builder, std::span<const PlacedMesh> instances) {
    std::vector<Box> boxes;
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t i = 0; i < instances.size(); ++i) {
        const Box box = world_box(instances[i]);
        if (box.empty()) continue;
        boxes.push_back(box);
        numbers.push_back(i);
    }
    const Bvh2 tree =
        Flatten(Level::Top).run(builder.build(boxes, {.triangle = InstanceCost, .leaf_triangles = 1}));
    const std::size_t node_bytes = tree.nodes.size() * sizeof(Bvh2Node);
    std::vector<std::byte> row(16 + node_bytes + tree.primitives.size() * sizeof(shading::BvhInstance));
    const auto instance_place = static_cast<std::uint32_t>(1 + node_bytes / 16);
    std::memcpy(row.data(), &instance_place, sizeof instance_place);
    std::memcpy(row.data() + 16, tree.nodes.data(), node_bytes);
    for (std::size_t i = 0; i < tree.primitives.size(); ++i) {
        const std::uint32_t number = numbers[tree.primitives[i]];
        const shading::BvhInstance record = record_of(instances[number], number, 0);
        std::memcpy(row.data() + 16 + node_bytes + i * sizeof record, &record, sizeof record);
    }
    return row;
}

}  // namespace tessera::vulkan
