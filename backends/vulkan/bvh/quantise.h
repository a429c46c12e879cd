#pragma once

#include <span>

#include "backends/vulkan/bvh/box.h"
#include "mediator/shading/bvh_layout.h"

namespace tessera::vulkan {

// How much larger than its content a child's box has to be, for rays that hit the content to enter the box.
//
// Rounding of the triangle test, with u = 2^-24: a corner's sheared coordinates go wrong by at most 4 u
// (difference, quotient, product, difference) of its distance from the ray's origin along the direction and
// across. That distance is the hit's, whose share is relative to the distances of the box's planes and in
// BvhSlack, and at most the box's extent more, in two axes: 2 * 4 u of the largest extent, taken twice.
inline constexpr double MarginOfExtent = 0x1p-20;
// Rounding of a plane's distance, start + q * step: 3 u of q <= 255 steps (bvh_keys), that is less than
// 2^-14; twice.
inline constexpr double MarginOfStep = 0x1p-13;

// Sets the frame (not the count in it) and the planes of all children; empty boxes are no children. Boxes lie
// within +-2^61.
void quantise(shading::BvhNode& node, std::span<const Box> children);

// The box of a child as the planes say, exactly.
struct PreciseBox {
    glm::dvec3 low, high;
};
PreciseBox quantised_box(const shading::BvhNode& node, std::uint32_t slot);

}  // namespace tessera::vulkan
