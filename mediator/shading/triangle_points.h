#ifndef TESSERA_MEDIATOR_SHADING_TRIANGLE_POINTS_H
#define TESSERA_MEDIATOR_SHADING_TRIANGLE_POINTS_H

#include "mediator/shading/rays.h"
#include "mediator/shading/scaling.h"

// Points on triangles with error bounds, and ray origins offset from them. `b`: barycentric weights of the
// second and third vertex.
SHADING_BEGIN

struct Triangle {
    vec3 p;
    vec3 q;
    vec3 r;
};

// Exact if both ends are equal.
inline vec3 between(vec3 from, vec3 to, float fraction) {
    return from + (to - from) * fraction;
}

// Of a deforming mesh: at a time (motion.h).
inline Triangle triangle_of(IN(Mesh) mesh, uvec3 corners) {
    const Triangle t = Triangle(mesh.positions.items[corners.x], mesh.positions.items[corners.y],
                                mesh.positions.items[corners.z]);
    if ((mesh.arrays & MeshDeforms) == 0u) return t;
    return Triangle(between(t.p, mesh.next_positions.items[corners.x], mesh.key_fraction),
                    between(t.q, mesh.next_positions.items[corners.y], mesh.key_fraction),
                    between(t.r, mesh.next_positions.items[corners.z], mesh.key_fraction));
}

struct PointWithError {
    vec3 position;
    vec3 error;  // bound of the rounding error, per axis
};

// n u / (1 - n u), u = 2^-24: bounds n roundings (Higham 2002).
inline float rounding_bound(float n) {
    return n * 5.9604644775390625e-8f / (1.0f - n * 5.9604644775390625e-8f);
}

// A point of an instance's triangle, and a bound per axis of how far from it a ray may hit the triangle. In
// the object's frame: interpolation, 5 roundings of the corners' coordinates; the distance to the plane, 8
// roundings (differences, cross product, dot product) of the triangle's extent. Then 6 roundings of the
// transform to world space, and as many of the ray's transform back.
inline PointWithError point_on(IN(Instance) instance, IN(Triangle) t, vec2 b) {
    const float first = 1.0f - b.x - b.y;
    const vec3 object = t.p * first + t.q * b.x + t.r * b.y;
    const vec3 sizes = abs(t.p) * abs(first) + abs(t.q) * b.x + abs(t.r) * b.y;
    const vec3 extent = max(max(abs(t.p - object), abs(t.q - object)), abs(t.r - object));
    const mat3 linear = mat3(abs(instance.linear[0]), abs(instance.linear[1]), abs(instance.linear[2]));
    const vec3 in_object = linear * (rounding_bound(5.0f) * sizes + rounding_bound(8.0f) * extent);
    const vec3 transform = linear * abs(object) + abs(instance.translation);
    return PointWithError(instance.linear * object + instance.translation,
                          in_object + 2.0f * rounding_bound(6.0f) * transform);
}

// Normal of the front, unit length; `otherwise` for a degenerate triangle. From the two shorter edges, whose
// angle is the triangle's largest: thin triangles keep their normal. Scaled, since products of a tiny
// triangle's edges underflow.
inline vec3 face_normal(IN(Instance) instance, IN(Triangle) t, vec3 otherwise) {
    const float scale = unit_scale(extent_of(max(abs(t.q - t.p), abs(t.r - t.p))));
    const vec3 pq = (t.q - t.p) * scale;
    const vec3 pr = (t.r - t.p) * scale;
    const vec3 qr = (t.r - t.q) * scale;
    const float pq2 = dot(pq, pq);
    const float pr2 = dot(pr, pr);
    const float qr2 = dot(qr, qr);
    const vec3 first = pq2 > max(pr2, qr2) ? pr : pq;
    const vec3 second = qr2 >= max(pr2, pq2) ? pr : qr;
    return direction_of(instance.normals * cross(first, second), otherwise);
}

// The next float in the direction of the sign of `towards`. From 0: the smallest number that no device
// flushes to 0.
inline float neighbour(float value, float towards) {
    if (value == 0.0f) return towards < 0.0f ? -1.17549435e-38f : 1.17549435e-38f;
    const uint bits = float_bits(value);
    return float_from_bits((value > 0.0f) == (towards > 0.0f) ? bits + 1u : bits - 1u);
}

// A sum, rounded away from the surface instead of back onto it.
inline float moved_by(float value, float offset) {
    return offset == 0.0f ? value : neighbour(value + offset, offset);
}

// Moves the point along the normal out of its error box, to the side `direction` leads to.
inline vec3 leave_surface(vec3 position, vec3 error, vec3 normal, vec3 direction) {
    const float distance = dot(abs(normal), error);
    const vec3 offset = dot(normal, direction) < 0.0f ? -distance * normal : distance * normal;
    return vec3(moved_by(position.x, offset.x), moved_by(position.y, offset.y),
                moved_by(position.z, offset.z));
}

SHADING_END

#endif
