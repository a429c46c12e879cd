#ifndef TESSERA_MEDIATOR_SHADING_ROUGH_GLASS_H
#define TESSERA_MEDIATOR_SHADING_ROUGH_GLASS_H

#include "mediator/shading/fresnel.h"
#include "mediator/shading/microfacets.h"
#include "mediator/shading/thin_film.h"

// A rough boundary of two dielectrics (Walter 2007), or thin-walled rough glass, which transmits straight on
// but for the roughness. Light is carried as basic radiance (perfect_specular.h). Multiple scattering between
// facets is not modelled. Directions as in microfacets.h; wi may lie below the surface.
SHADING_BEGIN

struct RoughGlass {
    vec3 tint;  // of transmitted light
    float eta;  // index of refraction on the far side / on this side
    vec3 f0;    // end points that Fresnel's equations are rescaled to (KHR_materials_specular):
    float f90;  // reflectance at normal incidence and at grazing
    vec2 alpha;
    uint thin;
    ThinFilm film;  // on the outside
};

// A smaller difference of indices is no boundary: light would be refracted by less than a ten thousandth of
// the facets' slope, and half vectors would be rounding noise.
inline constexpr float MinIndexDifference = 1e-4f;

inline bool is_boundary(float eta) {
    return abs(eta - 1.0f) > MinIndexDifference;
}

// `cosine`: in air.
COLD_NOINLINE inline vec3 thin_film_boundary_fresnel(IN(RoughGlass) glass, float cosine, vec3 plain) {
    const vec3 filmed = thin_film_dielectric(glass.film, film_light(glass.film, cosine), glass.f0);
    return plain + glass.film.strength * (filmed - plain);
}

// Fresnel's equations, rescaled to f0 and f90. Total reflection stays total.
inline vec3 adjusted_fresnel(IN(RoughGlass) glass, float cosine) {
    const float eta = glass.thin != 0u && glass.eta < 1.0f ? 1.0f / glass.eta : glass.eta;
    if (!(eta > 0.0f)) return vec3(1.0f);
    const float sine2 = (1.0f - cosine) * (1.0f + cosine);
    if (eta < 1.0f && !(refracted_cosine2(cosine, sine2, eta) > 0.0f)) return vec3(1.0f);
    const float start = normal_reflectance(eta);
    const float rise = (fresnel_dielectric(cosine, eta) - start) / (1.0f - start);
    const vec3 plain = glass.f0 + (vec3(glass.f90) - glass.f0) * greater_of(rise, 0.0f);
    if (!(glass.film.strength > 0.0f)) return plain;
    // By reciprocity: the reflectance from inside is that from outside at the refracted angle.
    return thin_film_boundary_fresnel(
        glass, eta < 1.0f ? sqrt(refracted_cosine2(cosine, sine2, eta)) : cosine, plain);
}

// Probability of sampling reflection instead of refraction.
inline float reflection_chance(IN(RoughGlass) glass, vec3 fresnel) {
    const float reflected = luminance(fresnel), through = luminance(glass.tint * (1.0f - fresnel));
    const float sum = reflected + through;
    return sum > 0.0f ? reflected / sum : 0.5f;
}

struct GlassValue {
    vec3 value;  // f |cos(wi)|
    float pdf;   // per solid angle
};

inline GlassValue evaluate_refraction(IN(RoughGlass) glass, vec3 wo, vec3 wi) {
    const GlassValue none = GlassValue(vec3(0.0f), 0.0f);
    const vec3 sum = wo + glass.eta * wi;
    const float length2 = dot(sum, sum);
    if (!(length2 > 0.0f)) return none;
    vec3 h = sum / sqrt(length2);
    if (h.z < 0.0f) h = -h;
    const float out_h = dot(wo, h), in_h = -dot(wi, h);
    if (!(out_h > 0.0f) || !(in_h > 0.0f)) return none;
    const vec3 fresnel = adjusted_fresnel(glass, out_h);
    const float turn = out_h - glass.eta * in_h;
    const float jacobian = glass.eta * glass.eta * in_h / (turn * turn);
    const float lambda_out = smith_lambda(wo, glass.alpha);
    const float density = ggx_distribution(h, glass.alpha) * out_h * jacobian / wo.z;
    const float passes = density / (1.0f + lambda_out + smith_lambda(wi, glass.alpha));
    return GlassValue(glass.tint * (1.0f - fresnel) * passes,
                      density / (1.0f + lambda_out) * (1.0f - reflection_chance(glass, fresnel)));
}

inline GlassValue evaluate_rough_glass(IN(RoughGlass) glass, vec3 wo, vec3 wi) {
    const bool reflects = wi.z > 0.0f;
    if (!reflects && glass.thin == 0u) return evaluate_refraction(glass, wo, wi);
    const vec3 up = vec3(wi.x, wi.y, abs(wi.z));
    const vec3 sum = wo + up;
    const float length2 = dot(sum, sum);
    if (!(length2 > 0.0f)) return GlassValue(vec3(0.0f), 0.0f);
    const vec3 h = sum / sqrt(length2);
    const vec3 fresnel = adjusted_fresnel(glass, dot(up, h));
    const float chance = reflection_chance(glass, fresnel);
    const Facets facets = facets_at(wo, up, h, glass.alpha);
    if (reflects) return GlassValue(fresnel * facets.value, facets.pdf * chance);
    return GlassValue(glass.tint * (1.0f - fresnel) * facets.value, facets.pdf * (1.0f - chance));
}

// The direction, or (0, 0, 0) if it is on the wrong side for its lobe, where it would count for another lobe.
inline vec3 on_side(vec3 direction, float side) {
    return direction.z * side > 0.0f ? direction : vec3(0.0f);
}

inline vec3 sample_rough_glass(IN(RoughGlass) glass, vec3 wo, float choice, vec2 u) {
    const vec3 h = sample_visible_normal(wo, glass.alpha, u);
    const float out_h = dot(wo, h);
    const vec3 mirrored = 2.0f * out_h * h - wo;
    if (choice < reflection_chance(glass, adjusted_fresnel(glass, out_h))) {
        return on_side(mirrored, 1.0f);
    }
    if (glass.thin != 0u) return on_side(vec3(mirrored.x, mirrored.y, -mirrored.z), -1.0f);
    const vec3 across = out_h * h - wo;
    const float inside2 = refracted_cosine2(out_h, dot(across, across), glass.eta);
    return on_side(unit_vector(across / glass.eta - sqrt(greater_of(inside2, 0.0f)) * h), -1.0f);
}

SHADING_END

#endif
