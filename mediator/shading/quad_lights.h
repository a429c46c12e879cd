#ifndef TESSERA_MEDIATOR_SHADING_QUAD_LIGHTS_H
#define TESSERA_MEDIATOR_SHADING_QUAD_LIGHTS_H

#include "mediator/shading/rays.h"
#include "mediator/shading/sampling.h"
#include "mediator/shading/scaling.h"

// One-sided rectangular lights, as seen from a point. Near ones are sampled by solid angle (Urena et al.
// 2013), far ones by area.
SHADING_BEGIN

// Density per solid angle of a point of a light of area 1 / inverse_root_area^2, seen at a distance and under
// a cosine. The ratio is squared, since the squares themselves leave the range of floats in tiny and huge
// scenes.
inline float area_pdf(float inverse_root_area, float distance, float cosine_there) {
    const float ratio = distance * inverse_root_area;
    return ratio * ratio / greater_of(cosine_there, 1e-30f);
}

// A rectangle in its own frame, the point at the origin: at the height z > 0 over it, between the corners low
// and high, in lengths of `unit`.
struct QuadView {
    vec2 low;
    vec2 high;
    float z;
    float unit;
    float solid_angle;  // 0: too small or too far, sampled by area
    float before;       // solid angle between x = 0 and low.x, less than 0 where that is less
};

// Solid angle of the rectangle between the point's projection and (x, y), with the sign of x y.
inline float corner_angle(float x, float y, float z) {
    return arc_tangent(x * y, z * sqrt(x * x + y * y + z * z));
}

// Beyond this many half diagonals, or below this solid angle (a difference of angles, with their rounding
// errors), a quad is sampled by area.
inline constexpr float FarQuad = 4.0f, SmallQuad = 0.01f;

inline QuadView view_quad(IN(LightSource) light, vec3 from) {
    const vec3 offset = light.position - from;
    const float unit = greater_of(extent_of(offset), greater_of(light.half_size.x, light.half_size.y));
    const vec3 scaled = offset / unit;
    const vec2 center = vec2(dot(scaled, light.edge_u), dot(scaled, light.edge_v));
    const vec2 half_size = light.half_size / unit;
    QuadView seen =
        QuadView(center - half_size, center + half_size, -dot(scaled, light.direction), unit, 0.0f, 0.0f);
    const bool is_far = dot(scaled, scaled) > FarQuad * FarQuad * dot(half_size, half_size);
    if (!(seen.z > 0.0f) || is_far) return seen;
    seen.before =
        corner_angle(seen.low.x, seen.high.y, seen.z) - corner_angle(seen.low.x, seen.low.y, seen.z);
    const float angle = corner_angle(seen.high.x, seen.high.y, seen.z) -
                        corner_angle(seen.high.x, seen.low.y, seen.z) - seen.before;
    if (angle > SmallQuad) seen.solid_angle = angle;
    return seen;
}

// A point relative to the center, along the edges: uniform over the solid angle, or over the area. First x:
// the solid angle to its left is the fraction u.x of all. Then y, whose sine over (x, z) is uniform.
inline vec2 sample_quad(IN(QuadView) seen, vec2 half_size, vec2 u) {
    if (!(seen.solid_angle > 0.0f)) return (2.0f * u - 1.0f) * half_size;
    const float z = seen.z;
    const float low_scale = inverse_sqrt(seen.low.y * seen.low.y + z * z);
    const float low = seen.low.y * low_scale;
    const float high = seen.high.y * inverse_sqrt(seen.high.y * seen.high.y + z * z);
    // The angle is that of the strip from 0 to x, which this solves for; low and high are sines at x = 0.
    const float angle = seen.before + u.x * seen.solid_angle;
    const float turned = sine(angle);
    const float along = high - low * cosine(angle), across = z * low_scale * abs(turned);
    const float rest = greater_of((along - across) * (along + across), 1e-20f);
    const float x = clamp(z * turned * inverse_sqrt(rest), seen.low.x, seen.high.x);
    const float d2 = x * x + z * z;
    const float from = seen.low.y * inverse_sqrt(seen.low.y * seen.low.y + d2);
    const float to = seen.high.y * inverse_sqrt(seen.high.y * seen.high.y + d2);
    const float sine_y = from + u.y * (to - from);
    const float left = greater_of((1.0f - sine_y) * (1.0f + sine_y), 1e-20f);
    const float y = clamp(sine_y * sqrt(d2) * inverse_sqrt(left), seen.low.y, seen.high.y);
    return (vec2(x, y) - 0.5f * (seen.low + seen.high)) * seen.unit;
}

// Per solid angle; `distance` and `facing`: of the direction that hits it.
inline float quad_pdf(IN(QuadView) seen, float inverse_root_area, float distance, float facing) {
    if (seen.solid_angle > 0.0f) return 1.0f / seen.solid_angle;
    return area_pdf(inverse_root_area, distance, facing);
}

SHADING_END

#endif
