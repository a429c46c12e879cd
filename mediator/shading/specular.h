#ifndef TESSERA_MEDIATOR_SHADING_SPECULAR_H
#define TESSERA_MEDIATOR_SHADING_SPECULAR_H

#include "mediator/shading/bsdf.h"

// Perfect mirrors and smooth glass: light goes on in one direction or two, without a density. Directions are
// in the shading frame (z = normal) and point away from the surface.
//   mirror  Schlick's Fresnel with F0 = base colour
//   glass   Fresnel's equations; what is refracted is tinted by the base colour, at every crossing
// Light is carried as basic radiance L / n^2 (Nicodemus 1963), which refraction does not change: the factors
// 1/eta^2 and eta^2 of entering and leaving a closed body cancel. Only what shines inside of glass is given
// as it would be in air.
SHADING_BEGIN

// Squared cosine on the far side, by Snell's law; not positive at total reflection. `sine2` is 1 - cosine^2,
// as its source can tell it best; eta as below, not 0. Towards the denser side (and none) in a form that does
// not cancel at grazing angles.
inline float refracted_cosine2(float cosine, float sine2, float eta) {
    const float eta2 = eta * eta;
    return eta >= 1.0f ? ((eta - 1.0f) * (eta + 1.0f) + cosine * cosine) / eta2 : 1.0f - sine2 / eta2;
}

// Share of unpolarised light that the smooth boundary of two dielectrics reflects. `cosine` is that of the
// direction and the normal, in [0, 1]; eta = index of refraction on the far side / on this side; eta = 0
// stands for an index without bound.
inline float fresnel_dielectric(float cosine, float eta) {
    if (eta == 1.0f) return 0.0f;
    if (!(eta > 0.0f)) return 1.0f;
    const float inside2 = refracted_cosine2(cosine, (1.0f - cosine) * (1.0f + cosine), eta);
    if (!(inside2 > 0.0f)) return 1.0f;
    const float inside = sqrt(inside2);
    const float parallel = (eta * cosine - inside) / (eta * cosine + inside);
    const float across = (cosine - eta * inside) / (cosine + eta * inside);
    return 0.5f * (parallel * parallel + across * across);
}

struct Specular {
    vec3 reflection, refraction;  // shares of the light that goes this way
    vec3 reflected, refracted;    // directions, of unit length where the share is not 0
};

// For mixtures without mirror and glass both shares are 0. At total reflection nothing is refracted.
inline Specular make_specular(vec3 base_color, IN(Mixture) mixture, float eta, vec3 wo) {
    Specular specular;
    const float fresnel = fresnel_dielectric(wo.z, eta);
    specular.reflected = vec3(-wo.x, -wo.y, wo.z);
    specular.reflection = mixture.mirror * (base_color + (1.0f - base_color) * schlick_weight(wo.z)) +
                          vec3(mixture.glass * fresnel);
    specular.refraction = base_color * (mixture.glass * (1.0f - fresnel));
    specular.refracted = vec3(0.0f);
    if (!(fresnel < 1.0f)) return specular;
    // 1 - cos^2 from x and y: it does not cancel near the normal.
    const float sine2 = wo.x * wo.x + wo.y * wo.y;
    const float inside = sqrt(greater_of(0.0f, refracted_cosine2(wo.z, sine2, eta)));
    specular.refracted = unit_vector(vec3(-wo.x / eta, -wo.y / eta, -inside));
    return specular;
}

SHADING_END

#endif
