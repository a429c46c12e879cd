#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "backends/vulkan/bvh/binary_tree.h"
#include "mediator/shading/bvh_layout.h"

namespace tessera::vulkan {

// Primitives of leaves: triangles, in an array of their own, or instances, in the array of the nodes.
enum class Level { Mesh, Top };

// A wide BVH in the layout of shading/bvh_layout.h. Descendants of a node are stored after it.
struct WideTree {
    std::vector<shading::BvhNode> nodes;    // Level::Top: places of instances are zero
    std::vector<std::uint32_t> primitives;  // Level::Mesh: of each place in the row of triangles; Top: of
                                            // each place in the row of nodes, NoPrimitive for nodes
    std::uint32_t depth = 0;                // levels of nodes
    Box box;
    double cost = 0.0;  // expected of a ray that meets the box (surface-area heuristic), in TraversalCosts

    static constexpr std::uint32_t NoPrimitive = 0xffffffffu;
};

// A refitted tree is rebuilt when its cost exceeds this multiple of its cost when it was built. Measured on
// lavapipe with two cores,
// a ball and a field of columns of 147,000 triangles each, twisted, torn apart and deformed: at 1.2, 1.5, 2 and 3
// times the cost, rays take 1.1, 1.1 to 1.3, 1.1 to 1.5 and 1.0 to 2.5 times as long as with a new tree. The
// extra time of building is paid back at 1.2 with 10 and more rays a triangle, at 1.5 with 3
// to 6, at 2 with 1 to 5. A picture of 1280 x 720 samples asks for some 7 million rays: at 1.5, scenes of 1
// to 2 million triangles are even after one picture. Faster devices are even later, since the host builds.
inline constexpr double RefitLimit = 1.5;

// The topology of the wide tree, without boxes (fit_boxes sets them). It is at most `max_depth` deep: where
// the cheapest tree is deeper, a balanced one is built instead.
WideTree collapse(const BinaryNode* root, Level level, std::uint32_t max_depth);

// Sets the boxes of all nodes, from the leaves up, and cost and box of the tree. `box_of(place)`: of a
// primitive by its place in WideTree::primitives, called from all threads of the calling arena. A quantised
// box holds the exact one and a margin (see Margin), as the traversal computes it.
void fit_boxes(WideTree& tree, Level level, const TraversalCosts& costs,
               const std::function<Box(std::uint32_t place)>& box_of);

}  // namespace tessera::vulkan
