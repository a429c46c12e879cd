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

struct Specular {
    vec3 reflection, refraction;  // shares of the light that goes this way
    vec3 reflected, refracted;    // directions, of unit length where the share is not 0
};

// For mixtures without mirror and glass both shares are 0. At total reflection nothing is refracted; through
// thin walls light goes straight on. `glass`: the boundary; its tint is the base colour.
inline Specular make_specular(IN(Mixture) mixture, IN(RoughGlass) glass, vec3 wo) {
    Specular specular;
    const vec3 fresnel = bent_fresnel(glass, wo.z);
    specular.reflected = vec3(-wo.x, -wo.y, wo.z);
    specular.reflection =
        mixture.mirror * (glass.tint + (1.0f - glass.tint) * schlick_weight(wo.z)) + mixture.glass * fresnel;
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

SHADING_END

#endif
