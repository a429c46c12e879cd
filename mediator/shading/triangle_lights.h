#ifndef TESSERA_MEDIATOR_SHADING_TRIANGLE_LIGHTS_H
#define TESSERA_MEDIATOR_SHADING_TRIANGLE_LIGHTS_H

#include "mediator/shading/sampling.h"
#include "mediator/shading/triangle_points.h"

// Triangles of mesh lights, as seen from a point. Near ones are sampled by solid angle (Arvo 1995), far ones by area.
SHADING_BEGIN

struct TriangleView {
    vec3 p, q, r;           // corners, the point at the origin, in lengths of their extent
    vec3 to_p, to_q, to_r;  // unit length
    float determinant;      // of those, at least 0
    float solid_angle;      // 0: sampled by area
};

// Beyond this distance of its center in square roots of its area, or below this solid angle, a triangle is sampled
// by area.
inline constexpr float FarTriangle = 3.0f, SmallTriangle = 0.01f;

inline bool is_by_solid_angle(IN(TriangleView) seen) {
    return seen.solid_angle > 0.0f;
}

// Of lengths whose square is a float; else shorter than a unit vector.
inline vec3 normalized(vec3 v) {
    return v * (1.0f / sqrt(greater_of(dot(v, v), 1e-36f)));
}

// inverse_root_area: as in Emitter.
inline TriangleView view_triangle(IN(Instance) instance, IN(Triangle) t, float inverse_root_area, vec3 from) {
    TriangleView seen;
    seen.solid_angle = 0.0f;
    const vec3 third = vec3(0.333333343f);
    const vec3 center =
        (instance.linear * (t.p * third + t.q * third + t.r * third) + instance.translation - from) *
        inverse_root_area;
    if (!(dot(center, center) < FarTriangle * FarTriangle)) return seen;
    const vec3 p = instance.linear * t.p + instance.translation - from;
    const vec3 q = instance.linear * t.q + instance.translation - from;
    const vec3 r = instance.linear * t.r + instance.translation - from;
    const float scale = unit_scale(greater_of(extent_of(p), greater_of(extent_of(q), extent_of(r))));
    seen.p = p * scale;
    seen.q = q * scale;
    seen.r = r * scale;
    seen.to_p = normalized(seen.p);
    seen.to_q = normalized(seen.q);
    seen.to_r = normalized(seen.r);
    seen.determinant = abs(dot(cross(seen.to_p, seen.to_q), seen.to_r));
    // Van Oosterom and Strackee 1983.
    const float angle =
        2.0f * arc_tangent(seen.determinant, 1.0f + dot(seen.to_p, seen.to_q) + dot(seen.to_q, seen.to_r) +
                                                 dot(seen.to_r, seen.to_p));
    if (angle > SmallTriangle) seen.solid_angle = angle;
    return seen;
}

// A direction into the triangle, uniform over its solid angle: first the part of the triangle with the fraction u.x
// of the solid angle, at p and q, then a point on the arc from q that ends it. With the angle A at p and half the
// part's solid angle h, the part's side y from p towards r has tan(y / 2) = sin(h) / (tan(pq / 2) sin(A - h)). Multiplied
// by sin(pq) it needs no length but sin(pr): sin(pq) / tan(pq / 2) = |p + q|^2 / 2.
inline vec3 sample_solid_angle(IN(TriangleView) seen, vec2 u) {
    const vec3 pq = cross(seen.to_p, seen.to_q), pr = cross(seen.to_p, seen.to_r);
    const float inverse_sine = 1.0f / greater_of(vector_length(pr), 1e-18f);
    const float half_part = 0.5f * u.x * seen.solid_angle;
    const float sine_half = sine(half_part);
    const vec3 middle = seen.to_p + seen.to_q;
    const float n = sine_half * (0.5f * dot(middle, middle));
    const float d =
        greater_of(seen.determinant * cosine(half_part) - dot(pq, pr) * sine_half, 0.0f) * inverse_sine;
    const float inverse_sum = 1.0f / greater_of(n * n + d * d, 1e-30f);
    const vec3 towards_r = (seen.to_r - dot(seen.to_r, seen.to_p) * seen.to_p) * inverse_sine;
    const vec3 end = ((d - n) * (d + n) * inverse_sum) * seen.to_p + (2.0f * n * d * inverse_sum) * towards_r;
    const vec3 across = end - seen.to_q;
    const float one_minus_z = 0.5f * u.y * dot(across, across);
    const vec3 towards_end = normalized(end - dot(end, seen.to_q) * seen.to_q);
    return (1.0f - one_minus_z) * seen.to_q +
           sqrt(greater_of(one_minus_z * (2.0f - one_minus_z), 0.0f)) * towards_end;
}

// Barycentric coordinates of q and r where the direction meets the triangle.
inline vec2 place_in_direction(IN(TriangleView) seen, vec3 direction) {
    const vec3 pq = seen.q - seen.p, pr = seen.r - seen.p;
    const vec3 side = cross(direction, pr);
    const float below = dot(pq, side);
    if (below == 0.0f) return vec2(0.333333343f);
    const float q = greater_of(-dot(seen.p, side) / below, 0.0f);
    const float r = greater_of(-dot(direction, cross(seen.p, pq)) / below, 0.0f);
    return vec2(q, r) / greater_of(q + r, 1.0f);
}

inline vec2 sample_triangle_light(IN(TriangleView) seen, vec2 u) {
    if (!is_by_solid_angle(seen)) return sample_triangle(u);
    return place_in_direction(seen, sample_solid_angle(seen, u));
}

SHADING_END

#endif
