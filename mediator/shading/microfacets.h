#ifndef TESSERA_MEDIATOR_SHADING_MICROFACETS_H
#define TESSERA_MEDIATOR_SHADING_MICROFACETS_H

#include "mediator/shading/sampling.h"

// GGX with height-correlated Smith shadowing (Walter 2007, Heitz 2014). Directions are in the shading frame
// (z = normal) and point away from the surface; `alpha` is the roughness along its x and y.
SHADING_BEGIN

// Smallest alpha: a mirror within float accuracy; below, D overflows.
inline constexpr float MinAlpha = 1e-4f;

// D of the half vector. In a form that does not cancel: 1 - cos^2 comes from x and y.
inline float ggx_distribution(vec3 h, vec2 alpha) {
    const float x = h.x * alpha.y, y = h.y * alpha.x;
    const float area = alpha.x * alpha.y;
    const float slope = (x * x + y * y) / area + area * h.z * h.z;
    return area * InversePi / (slope * slope);
}

inline float smith_lambda(vec3 w, vec2 alpha) {
    const float cos2 = w.z * w.z;
    if (!(cos2 > 0.0f)) return 1e20f;
    const float x = alpha.x * w.x, y = alpha.y * w.y;
    return 0.5f * (sqrt(1.0f + (x * x + y * y) / cos2) - 1.0f);
}

// Samples visible normals from `wo` (Heitz 2018).
inline vec3 sample_visible_normal(vec3 wo, vec2 alpha, vec2 u) {
    const vec3 stretched = unit_vector(vec3(alpha.x * wo.x, alpha.y * wo.y, wo.z));
    const float length2 = stretched.x * stretched.x + stretched.y * stretched.y;
    const vec3 t1 =
        length2 > 0.0f ? vec3(-stretched.y, stretched.x, 0.0f) / sqrt(length2) : vec3(1.0f, 0.0f, 0.0f);
    const vec3 t2 = cross(stretched, t1);
    // Warps the disk's point to the visible half, in a form that does not cancel at the rim: half_chord^2 = 1
    // - p.x^2, above = half_chord - p.y, below = half_chord + p.y, height^2 = above * below.
    const vec2 p = sample_disk(u);
    const float s = 0.5f * (1.0f + stretched.z), rest = 0.25f * length2 / s;  // sum 1
    const float height = height_over_disk(u);
    const float half_chord = sqrt(height * height + p.y * p.y);
    const float longer = half_chord + abs(p.y);
    const float shorter = longer > 0.0f ? height * height / longer : 0.0f;
    const float above = p.y > 0.0f ? shorter : longer, below = p.y > 0.0f ? longer : shorter;
    const float y = half_chord - s * above;
    const float z = sqrt(s * above * (2.0f * rest * half_chord + s * below));
    const vec3 h = p.x * t1 + y * t2 + z * stretched;
    return unit_vector(vec3(alpha.x * h.x, alpha.y * h.y, greater_of(1e-12f, h.z)));
}

// Reflection from wi to wo, both above the surface, by facets of normal h with reflectance 1.
struct Facets {
    float value;  // times the cosine of wi
    float pdf;    // of wi, per solid angle, with h by sample_visible_normal
};

inline Facets facets_at(vec3 wo, vec3 wi, vec3 h, vec2 alpha) {
    const float density = ggx_distribution(h, alpha) / (4.0f * wo.z);
    const float lambda_out = smith_lambda(wo, alpha);
    return Facets(density / (1.0f + lambda_out + smith_lambda(wi, alpha)), density / (1.0f + lambda_out));
}

SHADING_END

#endif
