#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "backends/vulkan/bvh/box.h"

namespace tessera::vulkan {

// Costs of a visit, relative to a node. Of triangle costs of 0.15, 0.3, 0.5 and 1, 0.3 gave the fastest trees on
// lavapipe (by 7 % and more).
struct TraversalCosts {
    float node = 1.0f;
    float triangle = 0.3f;
    std::uint32_t leaf_triangles = 3;  // at most per leaf; 1 to BvhLeafTriangles
};

struct BinaryNode {
    Box box;
    std::uint32_t count = 1;      // of primitives below
    std::uint32_t primitive = 0;  // if count is 1
};

// A node of two children, with the optimal collapse of its subtree into a wide tree by dynamic programming
// (Ylitie et al. 2017, section 3.1).
struct InnerNode : BinaryNode {
    static constexpr std::uint32_t MaxChildren = 7;

    const BinaryNode *left = nullptr, *right = nullptr;
    std::array<float, MaxChildren> cost{};  // as at most i + 1 children of a wide node
    std::array<std::uint8_t, MaxChildren>
        left_children{};  // how many of them are in the left subtree; 0: as with one child less
    std::uint8_t wide_left_children = 0;  // of 8 children, if this becomes a wide node
    bool leaf = false;                    // if it is one child: a leaf instead of a wide node
};

inline const InnerNode& as_inner(const BinaryNode& node) {
    return static_cast<const InnerNode&>(node);
}

// Wraps Embree's BVH builder. One build at a time.
class BinaryTreeBuilder final {
  public:
    BinaryTreeBuilder();  // throws Error{Unavailable} if Embree cannot be initialised

    // Splits by the surface-area heuristic with the threads of the calling arena. Leaves hold one primitive,
    // its index in `primitives`; boxes are finite. Null for no primitives. The nodes live until the next
    // build. Throws Error{OutOfMemory}.
    const BinaryNode* build(std::span<const Box> primitives, const TraversalCosts& costs);

  private:
    struct Release {
        void operator()(RTCDeviceTy* device) const { rtcReleaseDevice(device); }
        void operator()(RTCBVHTy* bvh) const { rtcReleaseBVH(bvh); }
    };
    std::unique_ptr<RTCDeviceTy, Release> device_;
    std::unique_ptr<RTCBVHTy, Release> bvh_;  // owns the nodes
};

}  // namespace tessera::vulkan
