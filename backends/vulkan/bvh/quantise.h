#pragma once

#include <span>

#include "backends/vulkan/bvh/box.h"
#include "mediator/shading/bvh_layout.h"

namespace tessera::vulkan {

// How much larger than its content a child's box has to be, so that rays that hit the content enter the box.
//
// Rounding of the triangle test, with u = 2^-24: a corner's sheared coordinates have an error of at most 4 u
// (difference, quotient, product, difference) of its distance from the ray's origin along the direction and
// across. That distance is at most the distance of the hit, whose part is relative to the distances of the box's
// planes and covered by BvhSlack, plus the extent of the box, in two axes: 2 * 4 u of the largest extent; doubled.
inline constexpr double MarginOfExtent = 0x1p-20;
// Rounding of a plane's distance, start + q * step: 3 u of q <= 255 steps (bvh_keys), that is less than
// 2^-14; doubled.
inline constexpr double MarginOfStep = 0x1p-13;

// Sets the frame (not the count in it) and the planes of all children; empty boxes mark unused slots. Boxes are
// within +-2^61.
void quantise(shading::BvhNode& node, std::span<const Box> children);

// The exact box that the quantised planes of a child represent.
struct PreciseBox {
    glm::dvec3 low, high;
};
PreciseBox quantised_box(const shading::BvhNode& node, std::uint32_t slot);

}  // namespace tessera::vulkan
