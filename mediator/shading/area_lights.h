#ifndef TESSERA_MEDIATOR_SHADING_AREA_LIGHTS_H
#define TESSERA_MEDIATOR_SHADING_AREA_LIGHTS_H

#include "mediator/shading/quad_lights.h"

// Sphere lights, quad lights and sun disks: lights with a size but without geometry. They are visible to all
// rays, and do not occlude.
SHADING_BEGIN

// 1 - sqrt(1 - x), without cancellation.
inline float one_minus_root(float x) {
    return x / (1.0f + sqrt(greater_of(0.0f, 1.0f - x)));
}

// A direction uniform over a cone around an axis.
inline vec3 sample_cone(vec3 axis, float one_minus_cos_half_angle, vec2 u) {
    const float x = u.x * one_minus_cos_half_angle;
    const float sine_theta = sqrt(x * (2.0f - x));
    const float phi = 2.0f * Pi * u.y;
    return unit_vector(frame_around(axis) * vec3(sine_theta * cosine(phi), sine_theta * sine(phi), 1.0f - x));
}

inline float cone_pdf(float one_minus_cos_half_angle) {
    return 1.0f / (2.0f * Pi * one_minus_cos_half_angle);
}

// Whether a direction lies in a cone: half the squared chord is 1 - cosine.
inline bool is_in_cone(vec3 axis, float one_minus_cos_half_angle, vec3 direction) {
    const vec3 chord = direction - axis;
    return dot(chord, chord) <= 2.0f * one_minus_cos_half_angle;
}

// A sphere as seen from a point.
struct SphereView {
    vec3 axis;                       // to its center, unit length; arbitrary at the center
    float distance;                  // of its center
    bool is_inside;                  // the point
    float one_minus_cos_half_angle;  // 1 - the cosine of the half angle that it spans; 2 from inside
};

inline SphereView view_sphere(IN(LightSource) light, vec3 from) {
    const DirectionAndDistance to_light = direction_and_distance(light.position - from);
    SphereView seen =
        SphereView(to_light.direction, to_light.distance, !(to_light.distance > light.radius), 2.0f);
    if (to_light.distance == 0.0f) seen.axis = vec3(0.0f, 0.0f, 1.0f);
    if (!seen.is_inside) {
        const float sine_of_cone = light.radius / to_light.distance;
        // Avoids underflow for very distant spheres: their light then loses energy, but stays finite.
        seen.one_minus_cos_half_angle = one_minus_root(greater_of(sine_of_cone * sine_of_cone, 1e-36f));
    }
    return seen;
}

// Distance at which a direction of the cone hits the sphere; from inside, where it leaves it. Computed in
// units of the larger of radius and distance, since their squares may overflow.
inline float sphere_distance(IN(LightSource) light, IN(SphereView) seen, vec3 direction) {
    const float unit = greater_of(seen.distance, light.radius);
    const float distance = seen.distance / unit, radius = light.radius / unit;
    const float along = dot(seen.axis, direction);
    // 1 - cosine^2 from the chord: no cancellation for distant lights.
    const vec3 chord = direction - seen.axis;
    const float chord2 = dot(chord, chord);
    const float sine2 = along > 0.0f ? chord2 * (1.0f - 0.25f * chord2) : (1.0f - along) * (1.0f + along);
    const float root = sqrt(greater_of(0.0f, radius * radius - distance * distance * sine2));
    return unit * (distance * along + (seen.is_inside ? root : -root));
}

// Intersection of a ray and a light.
struct LightHit {
    bool is_hit;
    float distance;
    float pdf;  // per solid angle, with which the light's sampling finds this direction
};

inline LightHit hit_sphere(IN(LightSource) light, IN(Ray) ray) {
    const SphereView seen = view_sphere(light, ray.origin);
    const bool is_hit = seen.is_inside || is_in_cone(seen.axis, seen.one_minus_cos_half_angle, ray.direction);
    return LightHit(is_hit, is_hit ? sphere_distance(light, seen, ray.direction) : 0.0f,
                    cone_pdf(seen.one_minus_cos_half_angle));
}

// From the side on which it shines; else none.
inline LightHit hit_quad(IN(LightSource) light, float inverse_root_area, IN(Ray) ray) {
    LightHit hit = LightHit(false, 0.0f, 0.0f);
    const float facing = -dot(light.direction, ray.direction);
    if (!(facing > 0.0f)) return hit;
    const vec3 to_center = light.position - ray.origin;
    hit.distance = -dot(to_center, light.direction) / facing;
    const vec3 across = hit.distance * ray.direction - to_center;
    hit.is_hit = abs(dot(across, light.edge_u)) <= light.half_size.x &&
                 abs(dot(across, light.edge_v)) <= light.half_size.y;
    hit.pdf =
        hit.is_hit ? quad_pdf(view_quad(light, ray.origin), inverse_root_area, hit.distance, facing) : 0.0f;
    return hit;
}

SHADING_END

#endif
