#ifndef TESSERA_MEDIATOR_SHADING_BVH_NODE_H
#define TESSERA_MEDIATOR_SHADING_BVH_NODE_H

#include "mediator/shading/bvh_layout.h"
#include "mediator/shading/bvh_ray.h"

// Intersects a ray with a node: which triangles to test, which children to visit and in which order.
SHADING_BEGIN

// Flags of a ray query. Passed as constants, so that compilers remove what is not needed.
inline constexpr uint BvhClosest = 0u;
inline constexpr uint BvhAny = 1u;     // any hit: children are visited in any order
inline constexpr uint BvhAlpha = 2u;   // hits on BvhAlphaTested instances count only if stops_ray()
inline constexpr uint BvhMotion = 4u;  // BvhMoves instances are evaluated at the ray's time; else all at
                                       // shutter open

// Slots of children, 3 bits each, the nearest lowest; a set bit above the last slot; from bit 25 on the count
// of inner children. BvhEnd instead: traversal is finished. BvhLeave: an instance is finished.
inline constexpr uint BvhEnd = 0u;
inline constexpr uint BvhLeave = 1u;
inline constexpr uint BvhInnerShift = 25u;
inline constexpr uint BvhRoot = (1u << 3u) | (1u << 25u);  // slot 0 of 1
inline constexpr uint BvhSlots = (1u << 25u) - 1u;

// Whether the nearest slot is an inner node.
inline bool bvh_is_node(uint list) {
    return (list & 7u) < (list >> BvhInnerShift);
}
inline bool bvh_is_empty(uint list) {
    return (list & BvhSlots) == 1u;
}
inline uint bvh_without_nearest(uint list) {
    return ((list & BvhSlots) >> 3u) | (list & ~BvhSlots);
}

// A box is entered later than left by at most this factor of rounding: 4 u in each distance of a box; about
// 10 u in that of a triangle, with u = 2^-24. The rest is in the boxes: the builder's margin.
inline constexpr float BvhSlack = 1.0f + 3.8146973e-06f;  // 1 + 2^-18

inline constexpr uint BvhMissed = 0x7f800000u;

inline vec4 bvh_bytes(uint packed) {
    return vec4(ivec4((uvec4(packed) >> uvec4(0u, 8u, 16u, 24u)) & 255u));
}

struct BvhFrame {
    vec3 step, start;  // distance of plane q = q * step + start
    bool down_x, down_y, down_z;
};

inline BvhFrame bvh_frame(IN(BvhRay) ray, vec3 origin, uint exponents) {
    const vec3 size =
        vec3(float_from_bits((exponents & 255u) << 23u), float_from_bits(((exponents >> 8u) & 255u) << 23u),
             float_from_bits(((exponents >> 16u) & 255u) << 23u));
    BvhFrame frame;
    frame.step = size * ray.inverse;
    frame.start = (origin - ray.origin) * ray.inverse;
    frame.down_x = ray.inverse.x < 0.0f;
    frame.down_y = ray.inverse.y < 0.0f;
    frame.down_z = ray.inverse.z < 0.0f;
    return frame;
}

// Sort keys of four children: the bits of the entry distance (which sort like the numbers, as none is
// negative), with the slot in the lowest three; BvhMissed if the box is missed between `near` and `far`.
inline uvec4 bvh_keys(IN(BvhFrame) frame, uvec3 low, uvec3 high, float near, float far, uint first_slot) {
    const vec4 enter_x = bvh_bytes(frame.down_x ? high.x : low.x) * frame.step.x + frame.start.x;
    const vec4 enter_y = bvh_bytes(frame.down_y ? high.y : low.y) * frame.step.y + frame.start.y;
    const vec4 enter_z = bvh_bytes(frame.down_z ? high.z : low.z) * frame.step.z + frame.start.z;
    const vec4 leave_x = bvh_bytes(frame.down_x ? low.x : high.x) * frame.step.x + frame.start.x;
    const vec4 leave_y = bvh_bytes(frame.down_y ? low.y : high.y) * frame.step.y + frame.start.y;
    const vec4 leave_z = bvh_bytes(frame.down_z ? low.z : high.z) * frame.step.z + frame.start.z;
    const vec4 enter = max(max(enter_x, enter_y), max(enter_z, vec4(near)));
    const vec4 leave = min(min(leave_x, leave_y), min(leave_z, vec4(far))) * BvhSlack;
    return uvec4(enter.x <= leave.x ? (float_bits(enter.x) & ~7u) | first_slot : BvhMissed,
                 enter.y <= leave.y ? (float_bits(enter.y) & ~7u) | (first_slot + 1u) : BvhMissed,
                 enter.z <= leave.z ? (float_bits(enter.z) & ~7u) | (first_slot + 2u) : BvhMissed,
                 enter.w <= leave.w ? (float_bits(enter.w) & ~7u) | (first_slot + 3u) : BvhMissed);
}

// The triangles of a leaf that was not missed, as bits of the node's mask.
inline uint bvh_leaf_mask(uint key, uint leaf) {
    return key < BvhMissed ? (leaf >> 5u) << (leaf & 31u) : 0u;
}

inline void bvh_order(INOUT(uint) a, INOUT(uint) b) {
    const uint less = min(a, b);
    b = max(a, b);
    a = less;
}

inline uint bvh_append(uint list, uint key) {
    return key < BvhMissed ? (list << 3u) | (key & 7u) : list;
}

struct BvhVisit {
    uint triangles;  // mask: bit i = triangle first_triangle + i
    uint list;       // of the children to visit
};

// The five items of a node. `sorted`: number of slots that are children to visit; the others are leaves.
inline BvhVisit bvh_visit(IN(BvhRay) ray, uvec4 item0, uvec4 item1, uvec4 item2, uvec4 item3, uvec4 item4,
                          float near, float far, uint sorted, uint query) {
    const vec3 origin = vec3(float_from_bits(item0.x), float_from_bits(item0.y), float_from_bits(item0.z));
    const BvhFrame frame = bvh_frame(ray, origin, item0.w);
    const uvec4 first =
        bvh_keys(frame, uvec3(item2.x, item2.z, item3.x), uvec3(item3.z, item4.x, item4.z), near, far, 0u);
    const uvec4 second =
        bvh_keys(frame, uvec3(item2.y, item2.w, item3.y), uvec3(item3.w, item4.y, item4.w), near, far, 4u);
    const uvec4 leaf0 = (uvec4(item1.z) >> uvec4(0u, 8u, 16u, 24u)) & 255u;
    const uvec4 leaf1 = (uvec4(item1.w) >> uvec4(0u, 8u, 16u, 24u)) & 255u;
    BvhVisit visit;
    visit.triangles = bvh_leaf_mask(first.x, leaf0.x) | bvh_leaf_mask(first.y, leaf0.y) |
                      bvh_leaf_mask(first.z, leaf0.z) | bvh_leaf_mask(first.w, leaf0.w) |
                      bvh_leaf_mask(second.x, leaf1.x) | bvh_leaf_mask(second.y, leaf1.y) |
                      bvh_leaf_mask(second.z, leaf1.z) | bvh_leaf_mask(second.w, leaf1.w);
    uint k0 = 0u < sorted ? first.x : BvhMissed, k1 = 1u < sorted ? first.y : BvhMissed;
    uint k2 = 2u < sorted ? first.z : BvhMissed, k3 = 3u < sorted ? first.w : BvhMissed;
    uint k4 = 4u < sorted ? second.x : BvhMissed, k5 = 5u < sorted ? second.y : BvhMissed;
    uint k6 = 6u < sorted ? second.z : BvhMissed, k7 = 7u < sorted ? second.w : BvhMissed;
    if ((query & BvhAny) == 0u) {
        // Batcher's odd-even merge sort: 19 exchanges.
        bvh_order(k0, k1), bvh_order(k2, k3), bvh_order(k4, k5), bvh_order(k6, k7);
        bvh_order(k0, k2), bvh_order(k1, k3), bvh_order(k4, k6), bvh_order(k5, k7);
        bvh_order(k1, k2), bvh_order(k5, k6);
        bvh_order(k0, k4), bvh_order(k1, k5), bvh_order(k2, k6), bvh_order(k3, k7);
        bvh_order(k2, k4), bvh_order(k3, k5);
        bvh_order(k1, k2), bvh_order(k3, k4), bvh_order(k5, k6);
    }
    uint list = bvh_append(1u, k7);
    list = bvh_append(list, k6);
    list = bvh_append(list, k5);
    list = bvh_append(list, k4);
    list = bvh_append(list, k3);
    list = bvh_append(list, k2);
    list = bvh_append(list, k1);
    list = bvh_append(list, k0);
    visit.list = list | (item0.w >> 24u) << BvhInnerShift;
    return visit;
}

SHADING_END

#endif
