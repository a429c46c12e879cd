#ifndef TESSERA_MEDIATOR_SHADING_PLAIN_TRACE_H
#define TESSERA_MEDIATOR_SHADING_PLAIN_TRACE_H

#include "mediator/shading/bvh_trace.h"

// The baseline that bvh_trace is measured against: two children a node, boxes as floats, read by address, one
// step of one kind a turn. Same question, same answer, same triangles and instances in the pool; trees of
// their own.
SHADING_BEGIN

inline constexpr uint PlainNodeItems = 4u;
inline constexpr uint PlainStackSize = 160u;  // two trees of at most PlainDepth levels
inline constexpr uint PlainDepth = 78u;

// A child: PlainNone; PlainLeaf with, in a mesh, the first triangle times 4 plus their count, in the top
// level the place of an instance; else the place of a node.
inline constexpr uint PlainLeaf = 0x80000000u;
inline constexpr uint PlainNone = 0xffffffffu;
inline constexpr uint PlainLeave = 0xfffffffeu;  // on the stack: the instance is finished

struct PlainNode {
    vec3 low0;
    uint child0;
    vec3 high0;
    uint child1;
    vec3 low1;
    uint unused0;
    vec3 high1;
    uint unused1;
};

// The top level starts with one item whose x says where the row of instances begins, counted from there.

#ifdef __cplusplus
static_assert(sizeof(PlainNode) == 16 * PlainNodeItems);
static_assert(offsetof(PlainNode, low0) == 0 && offsetof(PlainNode, child0) == 12);
static_assert(offsetof(PlainNode, high0) == 16 && offsetof(PlainNode, child1) == 28);
static_assert(offsetof(PlainNode, low1) == 32 && offsetof(PlainNode, high1) == 48);
static_assert(PlainStackSize >= 2 * PlainDepth + 2);
#endif

// Where the box of a child is entered; negative if it is missed.
inline float plain_enter(IN(BvhRay) ray, uint child, uvec4 low_item, uvec4 high_item, float near, float far) {
    const vec3 low = (bvh_corner(low_item) - ray.origin) * ray.inverse;
    const vec3 high = (bvh_corner(high_item) - ray.origin) * ray.inverse;
    const vec3 first = min(low, high), last = max(low, high);
    const float enter = max(max(first.x, first.y), max(first.z, near));
    const float leave = min(min(last.x, last.y), min(last.z, far)) * BvhSlack;
    return enter <= leave && child != PlainNone ? enter : -1.0f;
}

WITH_CONTEXT
inline Hit plain_trace(BvhItems pool, uint top, vec3 origin, vec3 direction, float near, float far,
                       uint question, uint layers, float time, IN(Context) context, uint seed) {
    Hit hit;
    hit.distance = far;
    hit.barycentric = vec2(0.0f, 0.0f);
    hit.instance = NoInstance;
    hit.triangle = 0u;
    uint stack[PlainStackSize];
    stack[0] = PlainNone;
    uint height = 0u;
    BvhPlace place = bvh_top(top + 1u, origin, direction);
    const uint instances = top + pool.items[top].x;
    uint child = 0u;
    while (child != PlainNone) {
        if (child == PlainLeave) {
            place = bvh_top(top + 1u, origin, direction);
            child = stack[height];
            height -= height > 0u ? 1u : 0u;
        } else if (child < PlainLeaf) {
            const uint node = place.nodes + child * PlainNodeItems;
            const uvec4 low0 = pool.items[node], high0 = pool.items[node + 1u];
            const uvec4 low1 = pool.items[node + 2u], high1 = pool.items[node + 3u];
            const float enter0 = plain_enter(place.ray, low0.w, low0, high0, near, hit.distance);
            const float enter1 = plain_enter(place.ray, high0.w, low1, high1, near, hit.distance);
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
            const uint at = instances + (child & ~PlainLeaf) * BvhInstanceItems;
            place = bvh_enter(pool, top, at, origin, direction, question, time);
            const bool hidden = bvh_is_hidden(pool, at, layers);
            stack[height + 1u] = PlainLeave;
            height += hidden ? 0u : 1u;
            child = hidden ? PlainLeave : 0u;
        } else {
            const uint first = (child & ~PlainLeaf) >> 2u;
            for (uint i = 0u; i < (child & 3u); ++i) {
                const Hit met = bvh_meet(pool, first + i, place, near, question, hit);
                const bool is_new = met.instance != hit.instance || met.triangle != hit.triangle;
                const bool asked = is_new && (question & place.flags & BvhAlpha) != 0u;
                if (!asked || stops_ray(context, met, seed)) hit = met;
            }
            child = stack[height];
            height -= height > 0u ? 1u : 0u;
            if ((question & BvhAny) != 0u && hit.instance != NoInstance) child = PlainNone;
        }
    }
    return hit;
}

SHADING_END

#endif
