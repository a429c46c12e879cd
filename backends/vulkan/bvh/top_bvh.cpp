#include "backends/vulkan/bvh/top_bvh.h"

#include <cstring>

namespace tessera::vulkan {

namespace {

using shading::BvhInstance;
using shading::BvhNode;

TraversalCosts instance_costs() {
    return {.triangle = InstanceCost, .leaf_triangles = 1};
}

// Boxes of all instances except empty ones.
std::vector<Box> world_boxes(std::span<const PlacedMesh> instances) {
    std::vector<Box> boxes;
    boxes.reserve(instances.size());
    for (const PlacedMesh& placed : instances) boxes.push_back(world_box(placed));
    return boxes;
}

void fit(TopBvh& top, std::span<const Box> boxes, std::span<const PlacedMesh> instances) {
    fit_boxes(top.tree, Level::Top, instance_costs(),
              [&](std::uint32_t place) { return boxes[top.tree.primitives[place]]; });
    static_assert(sizeof(BvhNode) == sizeof(BvhInstance));
    top.row.resize(top.tree.nodes.size() * sizeof(BvhNode));
    std::vector<glm::vec4> places;
    for (std::size_t place = 0; place < top.tree.nodes.size(); ++place) {
        std::byte* target = top.row.data() + place * sizeof(BvhNode);
        const std::uint32_t number = top.tree.primitives[place];
        if (number == WideTree::NoPrimitive) {
            std::memcpy(target, &top.tree.nodes[place], sizeof(BvhNode));
        } else {
            const auto place_item = static_cast<std::uint32_t>(top.row.size() / 16 + places.size());
            const BvhInstance record = record_of(instances[number], number, place_item);
            std::memcpy(target, &record, sizeof record);
            for (const shading::Affine3x4& at : instances[number].transform_keys) {
                const auto rows = rows_of(at);
                places.insert(places.end(), rows.begin(), rows.end());
            }
        }
    }
    const auto bytes = std::as_bytes(std::span(places));
    top.row.insert(top.row.end(), bytes.begin(), bytes.end());
}

}  // namespace

TopBvh build_top(BinaryTreeBuilder& builder, std::span<const PlacedMesh> instances) {
    const std::vector<Box> boxes = world_boxes(instances);
    std::vector<Box> kept_boxes;
    std::vector<std::uint32_t> kept;
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
        if (boxes[i].empty()) continue;
        kept_boxes.push_back(boxes[i]);
        kept.push_back(i);
    }
    TopBvh top;
    top.tree = collapse(builder.build(kept_boxes, instance_costs()), Level::Top, shading::BvhTopDepth);
    for (std::uint32_t& primitive : top.tree.primitives) {
        if (primitive != WideTree::NoPrimitive) primitive = kept[primitive];
    }
    fit(top, boxes, instances);
    return top;
}

bool refit_top(TopBvh& top, std::span<const PlacedMesh> instances, double built_cost) {
    if (top.tree.nodes.empty()) return false;
    const std::vector<Box> boxes = world_boxes(instances);
    std::vector<char> placed(instances.size());
    for (const std::uint32_t number : top.tree.primitives) {
        if (number == WideTree::NoPrimitive) continue;
        if (number >= boxes.size() || boxes[number].empty()) return false;
        placed[number] = 1;
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (placed[i] == 0 && !boxes[i].empty()) return false;
    }
    fit(top, boxes, instances);
    return top.tree.cost <= RefitLimit * built_cost;
}

}  // namespace tessera::vulkan
