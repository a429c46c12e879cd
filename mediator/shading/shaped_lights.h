#ifndef TESSERA_MEDIATOR_SHADING_SHAPED_LIGHTS_H
#define TESSERA_MEDIATOR_SHADING_SHAPED_LIGHTS_H

#include "mediator/shading/quad_lights.h"

// Spheres, quads and suns: lights with a size that are no geometry. They shine, are seen and stop no ray.
SHADING_BEGIN

// 1 - sqrt(1 - x), without cancellation.
inline float one_minus_root(float x) {
    return x / (1.0f + sqrt(greater_of(0.0f, 1.0f - x)));
}

// A direction around an axis, uniform over a cap; `cap` is 1 - the cosine of its half angle.
inline vec3 sample_cap(vec3 axis, float cap, vec2 u) {
    const float x = u.x * cap;
    const float sine_theta = sqrt(x * (2.0f - x));
    const float phi = 2.0f * Pi * u.y;
    return unit_vector(frame_around(axis) * vec3(sine_theta * cosine(phi), sine_theta * sine(phi), 1.0f - x));
}

inline float cap_pdf(float cap) {
    return 1.0f / (2.0f * Pi * cap);
}

// Whether a direction lies in a cap: half the squared chord is 1 - cosine.
inline bool is_in_cap(vec3 axis, float cap, vec3 direction) {
    const vec3 chord = direction - axis;
    return dot(chord, chord) <= 2.0f * cap;
}

// A sphere as seen from a point.
struct SphereView {
    vec3 axis;       // to its middle, unit length; any, where the point is the middle
    float distance;  // of its middle
    bool is_inside;  // the point
    float cap;       // 1 - the cosine of the half angle that it spans; 2 from inside
};

inline SphereView view_sphere(IN(LightSource) light, vec3 from) {
    const Measured way = measure(light.position - from);
    SphereView seen = SphereView(way.direction, way.distance, !(way.distance > light.radius), 2.0f);
    if (way.distance == 0.0f) seen.axis = vec3(0.0f, 0.0f, 1.0f);
    if (!seen.is_inside) {
        const float sine_of_cap = light.radius / way.distance;
        // Of a sphere so far that this square is no float light comes with less energy, but is a number.
        seen.cap = one_minus_root(greater_of(sine_of_cap * sine_of_cap, 1e-36f));
    }
    return seen;
}

// How far away a direction of the cap meets the sphere; from inside, where it leaves it. In units of the
// larger of radius and distance, whose squares may be no floats.
inline float sphere_distance(IN(LightSource) light, IN(SphereView) seen, vec3 direction) {
    const float unit = greater_of(seen.distance, light.radius);
    const float distance = seen.distance / unit, radius = light.radius / unit;
    const float along = dot(seen.axis, direction);
    // 1 - cosine^2 from the chord: it does not cancel for what is far.
    const vec3 chord = direction - seen.axis;
    const float chord2 = dot(chord, chord);
    const float sine2 = along > 0.0f ? chord2 * (1.0f - 0.25f * chord2) : (1.0f - along) * (1.0f + along);
    const float root = sqrt(greater_of(0.0f, radius * radius - distance * distance * sine2));
    return unit * (distance * along + (seen.is_inside ? root : -root));
}

// Where a ray meets a light.
struct ShapeHit {
    bool is_hit;
    float distance;
    float pdf;  // per solid angle, with which the light's sampling finds this direction
};

inline ShapeHit hit_sphere(IN(LightSource) light, IN(Ray) ray) {
    const SphereView seen = view_sphere(light, ray.origin);
    const bool is_hit = seen.is_inside || is_in_cap(seen.axis, seen.cap, ray.direction);
    return ShapeHit(is_hit, is_hit ? sphere_distance(light, seen, ray.direction) : 0.0f, cap_pdf(seen.cap));
}

// From the side on which it shines; else none.
inline ShapeHit hit_quad(IN(LightSource) light, float inverse_root_area, IN(Ray) ray) {
    ShapeHit hit = ShapeHit(false, 0.0f, 0.0f);
    const float facing = -dot(light.direction, ray.direction);
    if (!(facing > 0.0f)) return hit;
    const vec3 to_middle = light.position - ray.origin;
    hit.distance = -dot(to_middle, light.direction) / facing;
    const vec3 across = hit.distance * ray.direction - to_middle;
    hit.is_hit = abs(dot(across, light.edge_u)) <= light.half_size.x &&
                 abs(dot(across, light.edge_v)) <= light.half_size.y;
    hit.pdf =
        hit.is_hit ? quad_pdf(view_quad(light, ray.origin), inverse_root_area, hit.distance, facing) : 0.0f;
    return hit;
}

SHADING_END

#endif
