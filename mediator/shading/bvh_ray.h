#ifndef TESSERA_MEDIATOR_SHADING_BVH_RAY_H
#define TESSERA_MEDIATOR_SHADING_BVH_RAY_H

#include "mediator/shading/language.h"

// A ray against boxes and triangles. Directions need no unit length; distances are in lengths of the
// direction.
SHADING_BEGIN

struct BvhRay {
    vec3 origin, direction;
    vec3 inverse;  // of the direction; finite
    vec3 shear;    // of the direction in permuted axes: x / z, y / z, 1 / z
    uint axis;     // the direction's largest component, which the permutation puts last
};

// Components of the direction are at least this fraction of the largest one, so that reciprocals are finite.
// The resulting error, 5e-20 of the distance, is far within the margin of boxes (up to 1e13 of their extent
// away), and products with coordinates below 2^60 stay finite.
inline constexpr float BvhMinRelativeComponent = 5.4210109e-20f;  // 2^-64

inline float bvh_reciprocal(float x, float least) {
    return 1.0f / (abs(x) < least ? least : x);
}

// Cyclic, so that the axis comes last.
inline vec3 bvh_turned(uint axis, vec3 v) {
    return axis == 0u ? vec3(v.y, v.z, v.x) : axis == 1u ? vec3(v.z, v.x, v.y) : v;
}

inline BvhRay bvh_ray(vec3 origin, vec3 direction) {
    BvhRay ray;
    ray.origin = origin;
    ray.direction = direction;
    const vec3 sizes = abs(direction);
    const float least = max(sizes.x, max(sizes.y, sizes.z)) * BvhMinRelativeComponent;
    ray.inverse = vec3(bvh_reciprocal(direction.x, least), bvh_reciprocal(direction.y, least),
                       bvh_reciprocal(direction.z, least));
    ray.axis = sizes.x >= sizes.y && sizes.x >= sizes.z ? 0u : sizes.y >= sizes.z ? 1u : 2u;
    const vec3 turned = bvh_turned(ray.axis, direction);
    ray.shear = vec3(turned.x / turned.z, turned.y / turned.z, 1.0f / turned.z);
    return ray;
}

// Barycentric weights where the ray's line crosses a triangle's plane, times the triangle's projected area,
// signed.
struct BvhWeights {
    float a;
    float b;
    float c;
};

// The corners relative to the ray's origin, permuted.
inline BvhWeights bvh_weights(IN(BvhRay) ray, vec3 ta, vec3 tb, vec3 tc) {
    PRECISE const float ax = ta.x - ray.shear.x * ta.z;
    PRECISE const float ay = ta.y - ray.shear.y * ta.z;
    PRECISE const float bx = tb.x - ray.shear.x * tb.z;
    PRECISE const float by = tb.y - ray.shear.y * tb.z;
    PRECISE const float cx = tc.x - ray.shear.x * tc.z;
    PRECISE const float cy = tc.y - ray.shear.y * tc.z;
    PRECISE const float weight_a = cx * by - cy * bx;
    PRECISE const float weight_b = ax * cy - ay * cx;
    PRECISE const float weight_c = bx * ay - by * ax;
    return BvhWeights(weight_a, weight_b, weight_c);
}

struct BvhCrossing {
    float distance;
    vec2 barycentric;  // weights of the second and third corner
    bool crosses;
};

// Watertight (Woop, Benthin and Wald 2013): the corners are sheared into the ray's frame, each by itself, so
// triangles see a common corner at the same place; the signs of the edge functions are exact or zero, since
// rounding is monotonic and nothing is contracted; zero counts as inside. So no ray passes between triangles
// that share an edge or a corner. Triangles without projected area are missed. The distance is that to the
// plane, as Embree has it: its error is one of the origin's height above the plane, which a path can leave
// behind it (leave_surface), and is 0 where origin and triangle lie in one axis-aligned plane. It is clamped
// to the range of the corners' distances, which it could leave when the plane is hit edge-on.
inline BvhCrossing bvh_cross_triangle(IN(BvhRay) ray, vec3 a, vec3 b, vec3 c) {
    const vec3 from_a = a - ray.origin;
    const vec3 ta = bvh_turned(ray.axis, from_a);
    const vec3 tb = bvh_turned(ray.axis, b - ray.origin);
    const vec3 tc = bvh_turned(ray.axis, c - ray.origin);
    const BvhWeights weights = bvh_weights(ray, ta, tb, tc);
    const float sum = weights.a + weights.b + weights.c;
    const float scale = 1.0f / sum;
    const vec3 normal = cross(b - a, c - a);
    const float distance = dot(normal, from_a) / dot(normal, ray.direction);
    const float nearest = min(ta.z * ray.shear.z, min(tb.z * ray.shear.z, tc.z * ray.shear.z));
    const float farthest = max(ta.z * ray.shear.z, max(tb.z * ray.shear.z, tc.z * ray.shear.z));
    BvhCrossing crossing;
    crossing.distance = min(max(distance, nearest), farthest);
    crossing.barycentric = vec2(weights.b * scale, weights.c * scale);
    const float least = min(weights.a, min(weights.b, weights.c));
    const float greatest = max(weights.a, max(weights.b, weights.c));
    crossing.crosses = (least >= 0.0f || greatest <= 0.0f) && abs(sum) > 0.0f;  // false for NaN
    return crossing;
}

SHADING_END

#endif
