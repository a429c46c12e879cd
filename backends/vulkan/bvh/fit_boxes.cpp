#include <tbb/parallel_for.h>

#include <array>
#include <functional>

#include "backends/vulkan/bvh/quantise.h"
#include "backends/vulkan/bvh/wide_tree.h"

namespace tessera::vulkan {

namespace {

using shading::BvhNode;
using shading::BvhWidth;

constexpr std::uint32_t ParallelLevels = 3;  // 8^3 tasks are enough for any machine, and each is large enough

class Fit {
  public:
    Fit(WideTree& tree, Level level, const TraversalCosts& costs,
        const std::function<Box(std::uint32_t)>& box_of)
        : tree_(tree), level_(level), costs_(costs), box_of_(box_of) {}

    struct Part {
        Box box;
        double cost = 0.0;  // times area
    };

    Part node(std::uint32_t at, std::uint32_t depth) const {
        BvhNode& node = tree_.nodes[at];
        const std::uint32_t inner_count = node.frame >> 24u;
        std::array<Part, BvhWidth> parts;
        const auto descend = [&](std::uint32_t slot) {
            parts[slot] = this->node(node.first_child + slot, depth + 1);
        };
        if (depth < ParallelLevels) {
            tbb::parallel_for(0u, inner_count, descend);
        } else {
            for (std::uint32_t slot = 0; slot < inner_count; ++slot) descend(slot);
        }
        for (std::uint32_t slot = inner_count; slot < BvhWidth; ++slot) parts[slot] = leaf(node, slot);

        std::array<Box, BvhWidth> boxes;
        Part sum;
        for (std::uint32_t slot = 0; slot < BvhWidth; ++slot) {
            boxes[slot] = parts[slot].box;
            sum.box.add(parts[slot].box);
            sum.cost += parts[slot].cost;
        }
        quantise(node, boxes);
        sum.cost += sum.box.area() * costs_.node;
        return sum;
    }

  private:
    Part leaf(const BvhNode& node, std::uint32_t slot) const {
        Part part;
        std::uint32_t count = 0;
        if (level_ == Level::Top) {
            const std::uint32_t inner_count = node.frame >> 24u;
            count = slot - inner_count < node.first_triangle ? 1 : 0;
            if (count == 1) part.box = box_of_(node.first_child + slot);
        } else {
            const std::uint32_t byte = node.leaves[slot / 4] >> (8u * (slot % 4)) & 0xffu;
            for (; (byte >> 5u >> count & 1u) != 0; ++count) {
                part.box.add(box_of_(node.first_triangle + (byte & 31u) + count));
            }
        }
        part.cost = part.box.area() * costs_.triangle * count;
        return part;
    }

    WideTree& tree_;
    Level level_;
    const TraversalCosts& costs_;
    const std::function<Box(std::uint32_t)>& box_of_;
};

}  // namespace

void fit_boxes(WideTree& tree, Level level, const TraversalCosts& costs,
               const std::function<Box(std::uint32_t place)>& box_of) {
    const Fit::Part root = Fit(tree, level, costs, box_of).node(0, 0);
    tree.box = root.box;
    const double area = root.box.area();
    tree.cost = area > 0.0 ? root.cost / area : 0.0;
}

}  // namespace tessera::vulkan
