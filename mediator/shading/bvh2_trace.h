#ifndef TESSERA_MEDIATOR_SHADING_BVH2_TRACE_H
#define TESSERA_MEDIATOR_SHADING_BVH2_TRACE_H

#include "mediator/shading/bvh_trace.h"

// The baseline for benchmarks of bvh_trace: a BVH2 with float boxes, read by address, one node or leaf per
// iteration. Same queries, hits, triangles and instances as bvh_trace; its own trees.
SHADING_BEGIN

inline constexpr uint Bvh2NodeItems = 4u;
inline constexpr uint Bvh2StackSize = 160u;  // two trees of at most Bvh2MaxDepth levels
inline constexpr uint Bvh2MaxDepth = 78u;

// A child: Bvh2None; Bvh2Leaf with, in a mesh, the first triangle times 4 plus their count, in the top
// level the index of an instance; else the index of a node.
inline constexpr uint Bvh2Leaf = 0x80000000u;
inline constexpr uint Bvh2None = 0xffffffffu;
inline constexpr uint Bvh2LeaveInstance = 0xfffffffeu;  // on the stack: the instance is finished

struct Bvh2Node {
    vec3 low0;
    uint child0;
    vec3 high0;
    uint child1;
    vec3 low1;
    uint unused0;
    vec3 high1;
    uint unused1;
};

// The top level starts with one item whose x is the offset of the instances from there.

#ifdef __cplusplus
static_assert(sizeof(Bvh2Node) == 16 * Bvh2NodeItems);
static_assert(offsetof(Bvh2Node, low0) == 0 && offsetof(Bvh2Node, child0) == 12);
static_assert(offsetof(Bvh2Node, high0) == 16 && offsetof(Bvh2Node, child1) == 28);
static_assert(offsetof(Bvh2Node, low1) == 32 && offsetof(Bvh2Node, high1) == 48);
static_assert(Bvh2StackSize >= 2 * Bvh2MaxDepth + 2);
#endif

// Entry distance of a child's box; negative if it is missed.
inline float bvh2_enter(IN(BvhRay) ray, uint child, uvec4 low_item, uvec4 high_item, float near, float far) {
    const vec3 low = (bvh_corner(low_item) - ray.origin) * ray.inverse;
    const vec3 high = (bvh_corner(high_item) - ray.origin) * ray.inverse;
    const vec3 first = min(low, high), last = max(low, high);
    const float enter = max(max(first.x, first.y), max(first.z, near));
    const float leave = min(min(last.x, last.y), min(last.z, far)) * BvhSlack;
    return enter <= leave && child != Bvh2None ? enter : -1.0f;
}

WITH_CONTEXT
inline Hit bvh2_trace(BvhItems pool, uint top, vec3 origin, vec3 direction, float near, float far, uint query,
                      uint layers, float time, IN(Context) context, IN(Sampler) numbers) {
    Hit hit;
    hit.distance = far;
    hit.barycentric = vec2(0.0f, 0.0f);
    hit.instance = NoInstance;
    hit.triangle = 0u;
    uint stack[Bvh2StackSize];
    stack[0] = Bvh2None;
    uint height = 0u;
    BvhPlace place = bvh_top(top + 1u, origin, direction);
    const uint instances = top + pool.items[top].x;
    uint child = 0u;
    while (child != Bvh2None) {
        if (child == Bvh2LeaveInstance) {
            place = bvh_top(top + 1u, origin, direction);
            child = stack[height];
            height -= height > 0u ? 1u : 0u;
        } else if (child < Bvh2Leaf) {
            const uint node = place.nodes + child * Bvh2NodeItems;
            const uvec4 low0 = pool.items[node], high0 = pool.items[node + 1u];
            const uvec4 low1 = pool.items[node + 2u], high1 = pool.items[node + 3u];
            const float enter0 = bvh2_enter(place.ray, low0.w, low0, high0, near, hit.distance);
            const float enter1 = bvh2_enter(place.ray, high0.w, low1, high1, near, hit.distance);
            const bool second_first = enter1 >= 0.0f && (enter0 < 0.0f || enter1 < enter0);
            child = second_first ? high0.w : low0.w;
            if (enter0 >= 0.0f && enter1 >= 0.0f) {
                height += 1u;
                stack[height] = second_first ? low0.w : high0.w;
            } else if (enter0 < 0.0f && enter1 < 0.0f) {
                child = stack[height];
                height -= height > 0u ? 1u : 0u;
            }
        } else if (place.instance == NoInstance) {
            const uint at = instances + (child & ~Bvh2Leaf) * BvhInstanceItems;
            place = bvh_enter(pool, top, at, origin, direction, query, time);
            const bool hidden = bvh_is_hidden(pool, at, layers);
            stack[height + 1u] = Bvh2LeaveInstance;
            height += hidden ? 0u : 1u;
            child = hidden ? Bvh2LeaveInstance : 0u;
        } else {
            const uint first = (child & ~Bvh2Leaf) >> 2u;
            for (uint i = 0u; i < (child & 3u); ++i) {
                const Hit met = bvh_meet(pool, first + i, place, near, query, hit);
                const bool is_new = met.instance != hit.instance || met.triangle != hit.triangle;
                const bool needs_alpha_test = is_new && (query & place.flags & BvhAlpha) != 0u;
                if (!needs_alpha_test || stops_ray(context, met, numbers)) hit = met;
            }
            child = stack[height];
            height -= height > 0u ? 1u : 0u;
            if ((query & BvhAny) != 0u && hit.instance != NoInstance) child = Bvh2None;
        }
    }
    return hit;
}

SHADING_END

#endif
