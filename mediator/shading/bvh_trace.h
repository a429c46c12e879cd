#ifndef TESSERA_MEDIATOR_SHADING_BVH_TRACE_H
#define TESSERA_MEDIATOR_SHADING_BVH_TRACE_H

#include "mediator/shading/bvh_node.h"
#include "mediator/shading/motion.h"
#include "mediator/shading/rays.h"
#include "mediator/shading/sampler.h"

// Traversal of the two-level acceleration structure. Hits depend on the triangles only, not on the tree or
// the order of traversal, except for rays within a triangle's plane.
SHADING_BEGIN

ARRAY_OF(uvec4, BvhItems, 16);

// A shader may bind the pool as a texel buffer (R32G32B32A32_UINT) and define BVH_TEXELS as its name.
inline uvec4 bvh_item(BvhItems pool, uint at) {
#ifdef BVH_TEXELS
    return texelFetch(BVH_TEXELS, int(at));
#else
    return pool.items[at];
#endif
}

inline vec4 bvh_floats(uvec4 bits) {
    return vec4(float_from_bits(bits.x), float_from_bits(bits.y), float_from_bits(bits.z),
                float_from_bits(bits.w));
}

inline vec3 bvh_corner(uvec4 item) {
    return vec3(float_from_bits(item.x), float_from_bits(item.y), float_from_bits(item.z));
}

inline float bvh_row(vec4 row, vec3 v) {
    return row.x * v.x + row.y * v.y + row.z * v.z;
}

#ifndef __cplusplus
bool stops_ray(IN(Context) context, IN(Hit) candidate, IN(Sampler) numbers);
#endif

// Exact ties go to the lower instance, then to the lower triangle.
inline bool bvh_is_closer(IN(Hit) hit, float distance, uint instance, uint triangle) {
    return distance < hit.distance ||
           (distance == hit.distance &&
            (instance < hit.instance || (instance == hit.instance && triangle < hit.triangle)));
}

// Traversal state of a ray: in the top level (instance = NoInstance) or within an instance.
struct BvhPlace {
    BvhRay ray;
    uint nodes, corners;  // where the arrays start
    uint instance, flags;
    uint stride;           // of triangles, in items
    KeyInterval interval;  // of a deforming mesh
};

inline BvhPlace bvh_top(uint top, vec3 origin, vec3 direction) {
    BvhPlace place;
    place.ray = bvh_ray(origin, direction);
    place.nodes = top;
    place.corners = 0u;
    place.instance = NoInstance;
    place.flags = 0u;
    place.stride = BvhTriangleItems;
    place.interval = KeyInterval(0u, 0.0f);
    return place;
}

inline Affine3x4 bvh_place(BvhItems pool, uint at) {
    const vec4 x = bvh_floats(bvh_item(pool, at)), y = bvh_floats(bvh_item(pool, at + 1u));
    const vec4 z = bvh_floats(bvh_item(pool, at + 2u));
    return Affine3x4(mat3(vec3(x.x, y.x, z.x), vec3(x.y, y.y, z.y), vec3(x.z, y.z, z.z)),
                     vec3(x.w, y.w, z.w));
}

inline BvhPlace bvh_enter_moving(BvhItems pool, uint top, uint at, IN(BvhPlace) still, vec3 origin,
                                 vec3 direction, float time) {
    const uvec4 motion = bvh_item(pool, at + 4u);
    BvhPlace place = still;
    if (motion.z > 0u) {
        const KeyInterval interval = key_interval_at(motion.z, time);
        const uint from = top + motion.y + interval.index * BvhTransformItems;
        // A singular transform gives a ray that hits nothing.
        const Ray inner =
            ray_in_object(interpolate_transform(bvh_place(pool, from),
                                                bvh_place(pool, from + BvhTransformItems), interval.fraction),
                          origin, direction);
        place.ray = bvh_ray(inner.origin, inner.direction);
    }
    if (motion.w > 0u) {
        place.interval = key_interval_at(motion.w, time);
        place.stride = BvhTriangleItems * (motion.w + 1u);
    }
    return place;
}

// Directions are not normalised: distances stay those of world space.
inline BvhPlace bvh_enter(BvhItems pool, uint top, uint at, vec3 origin, vec3 direction, uint query,
                          float time) {
    const vec4 x = bvh_floats(bvh_item(pool, at)), y = bvh_floats(bvh_item(pool, at + 1u));
    const vec4 z = bvh_floats(bvh_item(pool, at + 2u));
    const uvec4 about = bvh_item(pool, at + 3u);
    BvhPlace place;
    place.ray = bvh_ray(vec3(bvh_row(x, origin) + x.w, bvh_row(y, origin) + y.w, bvh_row(z, origin) + z.w),
                        vec3(bvh_row(x, direction), bvh_row(y, direction), bvh_row(z, direction)));
    place.nodes = about.x;
    place.corners = about.y;
    place.instance = about.z;
    place.flags = about.w;
    place.stride = BvhTriangleItems;
    place.interval = KeyInterval(0u, 0.0f);
    if ((query & about.w & BvhMoves) == 0u) return place;
    return bvh_enter_moving(pool, top, at, place, origin, direction, time);
}

// Whether a ray with these layers skips the instance.
inline bool bvh_is_hidden(BvhItems pool, uint at, uint layers) {
    return layers != AllLayers && (bvh_item(pool, at + 4u).x & layers) == 0u;
}

struct BvhStep {
    uint first_child, first_triangle;
    BvhVisit visit;
};

inline BvhStep bvh_step(BvhItems pool, uint node, IN(BvhPlace) place, float near, float far, uint query) {
    const uvec4 item0 = bvh_item(pool, node), item1 = bvh_item(pool, node + 1u);
    const uint inner = item0.w >> 24u;
    const uint sorted = place.instance == NoInstance ? inner + item1.y : inner;
    BvhStep made;
    made.first_child = item1.x;
    made.first_triangle = item1.y;
    made.visit = bvh_visit(place.ray, item0, item1, bvh_item(pool, node + 2u), bvh_item(pool, node + 3u),
                           bvh_item(pool, node + 4u), near, far, sorted, query);
    return made;
}

inline Triangle bvh_triangle(BvhItems pool, uint at) {
    return Triangle(bvh_corner(bvh_item(pool, at)), bvh_corner(bvh_item(pool, at + 1u)),
                    bvh_corner(bvh_item(pool, at + 2u)));
}

inline BvhCrossing bvh_cross_moving(BvhItems pool, uint at, IN(BvhPlace) place) {
    const uint step = at + place.interval.index * BvhTriangleItems;
    const Triangle from = bvh_triangle(pool, step), to = bvh_triangle(pool, step + BvhTriangleItems);
    return bvh_cross_triangle(place.ray, between(from.p, to.p, place.interval.fraction),
                              between(from.q, to.q, place.interval.fraction),
                              between(from.r, to.r, place.interval.fraction));
}

// Intersects the triangle with this index in the array; returns the closer hit.
inline Hit bvh_meet(BvhItems pool, uint number, IN(BvhPlace) place, float near, uint query, IN(Hit) hit) {
    const bool moves = (query & BvhMotion) != 0u;
    const uint at = place.corners + number * (moves ? place.stride : BvhTriangleItems);
    const uvec4 a = bvh_item(pool, at), b = bvh_item(pool, at + 1u), c = bvh_item(pool, at + 2u);
    BvhCrossing crossing;
    if (moves && place.stride != BvhTriangleItems) {
        crossing = bvh_cross_moving(pool, at, place);
    } else {
        crossing = bvh_cross_triangle(place.ray, bvh_corner(a), bvh_corner(b), bvh_corner(c));
    }
    Hit met = hit;
    if (crossing.crosses && crossing.distance > near &&
        bvh_is_closer(hit, crossing.distance, place.instance, a.w)) {
        met.distance = crossing.distance;
        met.barycentric = crossing.barycentric;
        met.instance = place.instance;
        met.triangle = a.w;
    }
    return met;
}

// Intersects the remaining triangles of a leaf until one is hit that needs the alpha test: returns true, with
// that hit as the candidate.
inline bool bvh_meet_row(BvhItems pool, uint first_triangle, INOUT(uint) triangles, IN(BvhPlace) place,
                         float near, uint query, INOUT(Hit) hit, INOUT(Hit) candidate) {
    bool needs_alpha_test = false;
    while (triangles != 0u && !needs_alpha_test) {
        const uint number = first_triangle + lowest_bit(triangles);
        triangles &= triangles - 1u;
        candidate = bvh_meet(pool, number, place, near, query, hit);
        needs_alpha_test = (query & place.flags & BvhAlpha) != 0u &&
                           (candidate.instance != hit.instance || candidate.triangle != hit.triangle);
        if (!needs_alpha_test) hit = candidate;
    }
    return needs_alpha_test;
}

// The closest hit with near < distance <= far, or any; distance = far if there is none. `top`: where the
// top level's root is, in items. `layers`: instances in none of them are skipped; free of cost if it is the
// constant AllLayers. `time`: for BvhMotion. The including file defines Context and, before the include,
//     bool stops_ray(IN(Context) context, IN(Hit) candidate, IN(Sampler) numbers)
// Memory: BvhStackSize entries of 8 bytes; the builder bounds the depth of every tree.
WITH_CONTEXT
inline Hit bvh_trace(BvhItems pool, uint top, vec3 origin, vec3 direction, float near, float far, uint query,
                     uint layers, float time, IN(Context) context, IN(Sampler) numbers) {
    Hit hit = Hit(NoInstance, 0u, vec2(0.0f), far);
    uint stack_first[BvhStackSize];
    uint stack_list[BvhStackSize];
    stack_list[0] = BvhEnd;
    uint height = 0u;

    BvhPlace place = bvh_top(top, origin, direction);
    uint first = 0u, list = BvhRoot;  // children to visit
    uint triangles = 0u, first_triangle = 0u;
    Hit candidate = hit;

    // One loop with sequential parts: lanes that have reached triangles wait only for those still at nodes.
    // Nested loops, another order, and early exits from the inner loop were slower.
    while (list != BvhEnd || triangles != 0u) {
        while (triangles == 0u && bvh_is_node(list)) {
            const uint node = place.nodes + (first + (list & 7u)) * BvhNodeItems;
            list = bvh_without_nearest(list);
            // Written unconditionally: a branch would cost more.
            stack_first[height + 1u] = first;
            stack_list[height + 1u] = list;
            height += bvh_is_empty(list) ? 0u : 1u;
            const BvhStep made = bvh_step(pool, node, place, near, hit.distance, query);
            first = made.first_child;
            first_triangle = made.first_triangle;
            triangles = made.visit.triangles;
            list = made.visit.list;
            if (bvh_is_empty(list)) {
                first = stack_first[height];
                list = stack_list[height];
                height -= height > 0u ? 1u : 0u;
            }
        }
        const bool needs_alpha_test =
            bvh_meet_row(pool, first_triangle, triangles, place, near, query, hit, candidate);
        if ((query & BvhAlpha) != 0u && needs_alpha_test && stops_ray(context, candidate, numbers))
            hit = candidate;
        if ((query & BvhAny) != 0u && hit.instance != NoInstance) {
            triangles = 0u;
            list = BvhEnd;
        }
        if (triangles == 0u && list == BvhLeave) {
            first = stack_first[height];
            list = stack_list[height];
            height -= height > 0u ? 1u : 0u;
            if (bvh_is_node(list)) place = bvh_top(top, origin, direction);
        }
        if (triangles == 0u && list > BvhLeave && !bvh_is_node(list)) {  // into an instance
            const uint at = top + (first + (list & 7u)) * BvhInstanceItems;
            place = bvh_enter(pool, top, at, origin, direction, query, time);
            list = bvh_without_nearest(list);
            stack_first[height + 1u] = first;
            stack_list[height + 1u] = list;
            height += bvh_is_empty(list) ? 1u : 2u;
            stack_list[height] = BvhLeave;
            first = 0u;
            list = BvhRoot;
            if (bvh_is_hidden(pool, at, layers)) {  // and out again
                list = BvhLeave;
                height -= 1u;
            }
        }
    }
    return hit;
}

SHADING_END

#endif
