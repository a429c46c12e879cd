#ifndef TESSERA_MEDIATOR_SHADING_SHADING_NORMALS_H
#define TESSERA_MEDIATOR_SHADING_SHADING_NORMALS_H

#include "mediator/shading/bump.h"

// Where shading normals and the flat triangles disagree.
SHADING_BEGIN

// A normal that is turned because the viewer would not see it, or its mirrored ray would enter the face, leaves this
// cosine, and half of the viewer's with the face.
inline constexpr float LeastTurnedCosine = 0.01f;

// Sine and cosine of the largest angle p at which vx sin(p) + vz cos(p) = a cos(p - d) is `least`: p = d + arccos(least
// / a), with a = |(vx, vz)| and d = arctan(vx / vz).
inline vec2 sine_and_cosine_of_last(float vx, float vz, float least) {
    const float a2 = vx * vx + vz * vz;
    const float beyond = sqrt(greater_of(a2 - least * least, 0.0f));
    return vec2(vx * least + vz * beyond, vz * least - vx * beyond) / a2;
}

// The shading normal on the side that `direction` arrives on: turned towards the face's normal just so far that it
// faces the viewer. Continuous in both normals and in the direction.
inline vec3 seen_normal(vec3 normal, vec3 face, vec3 direction) {
    const vec3 up = dot(face, direction) < 0.0f ? face : -face;
    const vec3 seen = dot(normal, up) < 0.0f ? -normal : normal;
    const float vz = -dot(up, direction);
    const float least = lesser_of(0.5f * vz, LeastTurnedCosine);
    if (-dot(seen, direction) >= least) return seen;
    const vec3 x = direction_of(seen - dot(seen, up) * up, vec3(0.0f));
    if (!(vz > 0.0f) || x == vec3(0.0f)) return up;
    const vec2 last = sine_and_cosine_of_last(-dot(x, direction), vz, least);
    // Rounding at grazing angles: it would have to be turned the other way.
    if (last.y < dot(seen, up)) return up;
    return unit_vector(last.x * x + last.y * up);
}

// Of perfect mirrors: turned just so far that the mirrored ray leaves the face, which has the normal `up`. With the
// normal at the angle p that ray has the height vx sin(2 p) + vz cos(2 p) = a cos(2 p - d).
inline vec3 mirroring_normal(vec3 normal, vec3 up, vec3 direction) {
    const float vz = -dot(up, direction), nz = dot(normal, up);
    const float least = lesser_of(0.5f * vz, LeastTurnedCosine);
    if (-2.0f * dot(normal, direction) * nz - vz >= least) return normal;
    const vec3 x = direction_of(normal - nz * up, vec3(0.0f));
    if (!(vz > 0.0f) || x == vec3(0.0f)) return up;
    const vec2 twice = sine_and_cosine_of_last(-dot(x, direction), vz, least);
    const vec3 turned = direction_of(greater_of(twice.x, 0.0f) * x + (1.0f + twice.y) * up, up);
    // Rounding at grazing angles.
    return -2.0f * dot(turned, direction) * dot(turned, up) > vz ? turned : up;
}

// ---- the smooth surface that a mesh with vertex normals stands for ----

inline vec3 corner_normal(IN(Mesh) mesh, uint corner) {
    const vec3 normal = mesh.normals.items[corner];
    if ((mesh.arrays & MeshDeforms) == 0u) return normal;
    return between(normal, mesh.next_normals.items[corner], mesh.key_fraction);
}

// Vertex normals that differ by less than the first cosine stand for a smooth surface, by more than the second
// for none (a box with mean normals).
inline constexpr float SmoothCosine = 0.7f, EdgyCosine = 0.5f;

// From the triangle's point to the smooth surface, in the object's frame: the mean of its projections on the
// tangent planes of the corners with these normals, where they are above it, seen from the side of `side` x the normals
// (Hanika 2021, Hacking the Shadow Terminator). Rays that leave from there are not blocked by the flat triangles around,
// so no light is lost that arrives above the shading normal's horizon.
inline vec3 smooth_lift(IN(Triangle) t, vec3 n0, vec3 n1, vec3 n2, vec2 b, float side) {
    const float turn = lesser_of(dot(n0, n1), lesser_of(dot(n1, n2), dot(n2, n0)));
    const float share = clamp((turn - EdgyCosine) / (SmoothCosine - EdgyCosine), 0.0f, 1.0f) * side;
    const vec3 pq = t.q - t.p, pr = t.r - t.p;
    const vec3 place = pq * b.x + pr * b.y;
    const float d0 = side * dot(place, n0), d1 = side * dot(place - pq, n1), d2 = side * dot(place - pr, n2);
    const vec3 lift = n0 * (lesser_of(d0, 0.0f) * (1.0f - b.x - b.y)) + n1 * (lesser_of(d1, 0.0f) * b.x) +
                      n2 * (lesser_of(d2, 0.0f) * b.y);
    return -share * lift;
}

SHADING_END

#endif
