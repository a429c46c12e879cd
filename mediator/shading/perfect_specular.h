#ifndef TESSERA_MEDIATOR_SHADING_PERFECT_SPECULAR_H
#define TESSERA_MEDIATOR_SHADING_PERFECT_SPECULAR_H

#include "mediator/shading/bsdf.h"

// Perfect mirrors and smooth glass: delta lobes, without a density. Directions are
// in the shading frame (z = normal) and point away from the surface.
//   mirror  Schlick's Fresnel with F0 = base colour, or a film's on it (thin_film.h)
//   glass   Fresnel's equations; refracted light is tinted by the base colour at every crossing
//   face    of a smooth dielectric over its diffuse base: the specular lobe's Fresnel (surfaces.h)
// Light is carried as basic radiance L / n^2 (Nicodemus 1963), which refraction does not change: the factors
// 1/eta^2 and eta^2 of entering and leaving a closed mesh cancel. Only emitters inside of glass are as
// they would be in air.
SHADING_BEGIN

struct Specular {
    vec3 reflection, refraction;  // weights of the light from each direction
    vec3 reflected, refracted;    // directions, of unit length if the weight is not 0
    bool splits;                  // dispersion: each colour channel is refracted into its own direction, from
    vec3 arriving;                // the direction of the ray,
    vec3 normal;                  // the normal and
    vec3 eta;                     // the indices of refraction
};

inline Specular no_specular() {
    return Specular(vec3(0.0f), vec3(0.0f), vec3(0.0f), vec3(0.0f), false, vec3(0.0f), vec3(0.0f),
                    vec3(1.0f));
}

// Of metal in the tint's colour, under the thin film.
inline vec3 mirror_fresnel(IN(RoughGlass) glass, float cosine) {
    const vec3 plain = glass.tint + (1.0f - glass.tint) * schlick_weight(cosine);
    if (!(glass.film.strength > 0.0f)) return plain;
    const vec3 filmed = thin_film_reflectances(film_light(glass.film, cosine), glass.tint);
    return plain + glass.film.strength * (filmed - plain);
}

// Both weights are 0 for mixtures without mirror and glass. There is no refraction at total reflection;
// thin-walled glass transmits straight on. `glass`: the boundary; its tint is the base colour.
inline Specular make_specular(IN(Mixture) mixture, IN(RoughGlass) glass, vec3 wo) {
    Specular specular = no_specular();
    const vec3 fresnel = adjusted_fresnel(glass, wo.z);
    specular.reflected = vec3(-wo.x, -wo.y, wo.z);
    specular.reflection = mixture.mirror * mirror_fresnel(glass, wo.z) + mixture.glass * fresnel;
    specular.refraction = glass.tint * (1.0f - fresnel) * mixture.glass;
    specular.refracted = -wo;
    if (glass.thin != 0u || !(mixture.glass > 0.0f)) return specular;
    if (!(largest(specular.refraction) > 0.0f)) {
        specular.refracted = vec3(0.0f);
        return specular;
    }
    // 1 - cos^2 from x and y: it does not cancel near the normal.
    const float sine2 = wo.x * wo.x + wo.y * wo.y;
    const float inside = sqrt(greater_of(0.0f, refracted_cosine2(wo.z, sine2, glass.eta)));
    specular.refracted = unit_vector(vec3(-wo.x / glass.eta, -wo.y / glass.eta, -inside));
    return specular;
}

// Snell's law, for a ray direction that arrives on the normal's side. At total reflection: along the surface.
inline vec3 refracted_direction(vec3 direction, vec3 normal, float eta) {
    const float cosine = -dot(direction, normal);
    const vec3 across = direction + cosine * normal;
    const float inside2 = refracted_cosine2(cosine, dot(across, across), eta);
    return unit_vector(across / eta - sqrt(greater_of(inside2, 0.0f)) * normal);
}

// CommonSurfaceShader's perfect lobes (surface_shader_lobes.h). Directions in the world; `direction` arrives
// on the normal's side. With dispersion `refracted` is the direction of green.
inline Specular perfect_specular(IN(PerfectPart) part, vec3 direction, vec3 normal) {
    Specular specular = no_specular();
    const float cosine = clamp(-dot(direction, normal), 0.0f, 1.0f);
    const PerfectFractions fractions = perfect_fractions(part, cosine);
    specular.reflection = fractions.reflected;
    specular.refraction = fractions.refracted;
    specular.reflected = unit_vector(direction + 2.0f * cosine * normal);
    if (!(largest(fractions.refracted) > 0.0f)) return specular;
    specular.refracted = part.eta.y == 1.0f ? direction : refracted_direction(direction, normal, part.eta.y);
    specular.splits = disperses(part);
    specular.arriving = direction;
    specular.normal = normal;
    specular.eta = part.eta;
    return specular;
}

// With dispersion a path follows one colour channel, weighted by 3 unless it is already the only one.
struct Refraction {
    vec3 weight;
    vec3 direction;
};

inline Refraction refraction_of(IN(Specular) specular, uint channel, bool is_single_channel) {
    if (!specular.splits) return Refraction(specular.refraction, specular.refracted);
    const vec3 one =
        vec3(channel == 0u ? 1.0f : 0.0f, channel == 1u ? 1.0f : 0.0f, channel == 2u ? 1.0f : 0.0f);
    return Refraction(specular.refraction * one * (is_single_channel ? 1.0f : 3.0f),
                      refracted_direction(specular.arriving, specular.normal, dot(specular.eta, one)));
}

SHADING_END

#endif
