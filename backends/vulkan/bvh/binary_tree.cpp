#include "backends/vulkan/bvh/binary_tree.h"

#include <algorithm>
#include <limits>
#include <new>
#include <string>
#include <vector>

#include "mediator/base/error.h"

namespace tessera::vulkan {

namespace {

constexpr std::uint32_t MaxDepth = 64;  // beyond it Embree splits in halves, ignoring areas

float cost_of(const BinaryNode& node, std::uint32_t max_children, const TraversalCosts& costs) {
    if (node.count > 1) return as_inner(node).cost[std::min(max_children, InnerNode::MaxChildren) - 1];
    return static_cast<float>(node.box.area()) * costs.triangle;
}

struct Division {
    float cost = std::numeric_limits<float>::infinity();
    std::uint8_t left_children = 0;
};

// The cheapest split of at most `max_children` children between both sides.
Division divide(const InnerNode& node, std::uint32_t max_children, const TraversalCosts& costs) {
    Division best;
    for (std::uint32_t left_count = 1; left_count < max_children; ++left_count) {
        const float cost =
            cost_of(*node.left, left_count, costs) + cost_of(*node.right, max_children - left_count, costs);
        if (cost < best.cost) best = {cost, static_cast<std::uint8_t>(left_count)};
    }
    return best;
}

void decide(InnerNode& node, const TraversalCosts& costs) {
    const auto area = static_cast<float>(node.box.area());
    const Division wide = divide(node, InnerNode::MaxChildren + 1, costs);
    node.wide_left_children = wide.left_children;
    const float as_wide = wide.cost + area * costs.node;
    const float as_leaf = area * costs.triangle * static_cast<float>(node.count);
    // Written so that NaN costs give a wide node.
    node.leaf = node.count <= costs.leaf_triangles && as_leaf <= as_wide;
    node.cost[0] = node.leaf ? as_leaf : as_wide;
    for (std::uint32_t max_children = 2; max_children <= InnerNode::MaxChildren; ++max_children) {
        const Division division = divide(node, max_children, costs);
        const bool better = division.cost < node.cost[max_children - 2];
        node.cost[max_children - 1] = better ? division.cost : node.cost[max_children - 2];
        node.left_children[max_children - 1] = better ? division.left_children : 0;
    }
}

void* create_node(RTCThreadLocalAllocator allocator, unsigned, void*) {
    return new (rtcThreadLocalAlloc(allocator, sizeof(InnerNode), 16)) InnerNode;
}

void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, std::size_t,
                  void*) {
    auto* leaf = new (rtcThreadLocalAlloc(allocator, sizeof(BinaryNode), 16)) BinaryNode;
    leaf->box.low = {primitives->lower_x, primitives->lower_y, primitives->lower_z};
    leaf->box.high = {primitives->upper_x, primitives->upper_y, primitives->upper_z};
    leaf->primitive = primitives->primID;
    return leaf;
}

// Called when both children are complete, on all threads.
void set_children(void* parent, void** children, unsigned, void* costs) {
    auto& node = *static_cast<InnerNode*>(parent);
    node.left = static_cast<const BinaryNode*>(children[0]);
    node.right = static_cast<const BinaryNode*>(children[1]);
    node.box = node.left->box;
    node.box.add(node.right->box);
    node.count = node.left->count + node.right->count;
    decide(node, *static_cast<const TraversalCosts*>(costs));
}

void ignore_bounds(void*, const RTCBounds**, unsigned, void*) {}

}  // namespace

BinaryTreeBuilder::BinaryTreeBuilder() : device_(rtcNewDevice(nullptr)) {
    if (!device_) {
        throw Error(ErrorCode::Unavailable,
                    "cannot initialise Embree, which builds acceleration structures: error " +
                        std::to_string(rtcGetDeviceError(nullptr)) + "; use another machine");
    }
}

const BinaryNode* BinaryTreeBuilder::build(std::span<const Box> boxes, const TraversalCosts& costs) {
    bvh_.reset();
    if (boxes.empty()) return nullptr;
    bvh_.reset(rtcNewBVH(device_.get()));
    std::vector<RTCBuildPrimitive> primitives(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const Box& box = boxes[i];
        primitives[i] = {box.low.x,  box.low.y,  box.low.z,  0,
                         box.high.x, box.high.y, box.high.z, static_cast<unsigned>(i)};
    }
    TraversalCosts used = costs;
    RTCBuildArguments arguments = rtcDefaultBuildArguments();
    arguments.byteSize = sizeof arguments;
    arguments.maxBranchingFactor = 2;
    arguments.maxDepth = MaxDepth;
    arguments.maxLeafSize = 1;
    arguments.bvh = bvh_.get();
    arguments.primitives = primitives.data();
    arguments.primitiveCount = arguments.primitiveArrayCapacity = primitives.size();
    arguments.createNode = create_node;
    arguments.setNodeChildren = set_children;
    arguments.setNodeBounds = ignore_bounds;
    arguments.createLeaf = create_leaf;
    arguments.userPtr = &used;
    const void* root = rtcBuildBVH(&arguments);
    if (root == nullptr) {
        throw Error(ErrorCode::OutOfMemory, "Embree cannot build a tree over " +
                                                std::to_string(boxes.size()) + " boxes: error " +
                                                std::to_string(rtcGetDeviceError(device_.get())) +
                                                "; use a machine with more memory");
    }
    return static_cast<const BinaryNode*>(root);
}

}  // namespace tessera::vulkan
