#ifndef TESSERA_MEDIATOR_SHADING_GLASS_MULTISCATTER_H
#define TESSERA_MEDIATOR_SHADING_GLASS_MULTISCATTER_H

#include "mediator/shading/energy.h"
#include "mediator/shading/rough_glass.h"

// Multiple scattering between the facets of rough glass, as a Lambertian lobe on each side (Kulla and Conty
// 2017). With L = 1 - albedo of single scattering, on this side and on the far side, l = its mean over all
// directions, n = index of refraction on the far side / on this side:
//   reflected:   L(o) L(i) (1 - x) / (pi l)
//   transmitted: L(o) L'(i) x / (pi l')
// which returns L(o) for every x. Reciprocity asks for x l = x' l' n^2, seen from both sides. Of light that meets
// facets in random directions, 1 - mean Fresnel passes; the side that loses less has this x, the other follows.
// Random walks over the facets (Heitz 2016) for indices of 1.1 to 3 and roughness 0.3 to 1 give an x within
// 0.22 of it.
SHADING_BEGIN

struct GlassMultiscatter {
    vec3 reflected, transmitted;  // for wo; to be multiplied by L(i) cos(i)
    float chance;                 // of sampling this instead of single scattering
    float through;                // of this, of sampling the far side
};

// Albedo of one boundary whose Fresnel term is f0 + (f90 - f0) r, r rising from 0 to 1, and 1 at total
// reflection: x + f0 y + (f90 - f0) z of `glass_energy`. A thin film may reflect any fraction.
inline vec3 glass_albedo(IN(RoughGlass) glass, vec3 energy) {
    const vec3 plain = vec3(energy.x) + glass.f0 * energy.y + (vec3(glass.f90) - glass.f0) * energy.z;
    const float most = energy.x + greater_of(energy.y, 0.0f);
    return plain + glass.film.strength * (vec3(most) - plain);
}

// 1 - albedo for single scattering; `far`: of light on the far side.
inline vec3 glass_loss(FloatArray table, IN(RoughGlass) glass, float roughness, float cosine, bool far) {
    if (glass.thin != 0u) {
        const vec2 energy = lobe_energy(table, cosine, roughness);
        return vec3(greater_of(1.0f - energy.x - energy.y, 0.0f));
    }
    const vec3 energy = glass_energy(table, far ? 1.0f / glass.eta : glass.eta, cosine, roughness);
    return greater_of(vec3(1.0f) - glass_albedo(glass, energy), 0.0f);
}

// Its mean over all directions, weighted by the cosine.
inline vec3 mean_glass_loss(FloatArray table, IN(RoughGlass) glass, float roughness, bool far) {
    if (glass.thin != 0u) {
        const vec2 energy = mean_lobe_energy(table, roughness);
        return vec3(1.0f - energy.x - energy.y);
    }
    const vec3 energy = mean_glass_energy(table, far ? 1.0f / glass.eta : glass.eta, roughness);
    return greater_of(vec3(1.0f) - glass_albedo(glass, energy), 0.0f);
}

inline GlassMultiscatter no_glass_multiscatter() {
    return GlassMultiscatter(vec3(0.0f), vec3(0.0f), 0.0f, 0.0f);
}

// The tables are for isotropic roughness: with anisotropy there is no compensation.
inline GlassMultiscatter glass_multiscatter(FloatArray table, IN(RoughGlass) glass, float roughness,
                                            float cos_out) {
    if (glass.alpha.x != glass.alpha.y) return no_glass_multiscatter();
    const vec3 here = mean_glass_loss(table, glass, roughness, false);
    const vec3 far = mean_glass_loss(table, glass, roughness, true);
    const float eta2 = glass.thin != 0u ? 1.0f : glass.eta * glass.eta;
    // Equal to (1 - x) / l and x / l'.
    vec3 reflected = vec3(0.0f), transmitted = vec3(0.0f);
    for (int i = 0; i < 3; ++i) {
        const float most = greater_of(here[i], far[i] * eta2);
        if (!(most > MinMultiscatter)) continue;
        const float passing = 1.0f - mean_schlick(glass.f0[i], glass.f90);
        transmitted[i] = passing * eta2 / most;
        if (here[i] > MinMultiscatter) reflected[i] = (1.0f - transmitted[i] * far[i]) / here[i];
    }
    const vec3 loss = glass_loss(table, glass, roughness, cos_out, false) * InversePi;
    reflected *= loss;
    transmitted *= loss * glass.tint;
    const float up = Pi * luminance(reflected * here), down = Pi * luminance(transmitted * far);
    if (!(up + down > 0.0f)) return no_glass_multiscatter();
    return GlassMultiscatter(reflected, transmitted, lesser_of(up + down, 1.0f), down / (up + down));
}

inline GlassValue evaluate_glass_multiscatter(FloatArray table, IN(RoughGlass) glass,
                                              IN(GlassMultiscatter) multiscatter, float roughness, vec3 wi) {
    const float cosine = abs(wi.z);
    const bool far = wi.z < 0.0f;
    const vec3 loss = glass_loss(table, glass, roughness, cosine, far);
    const float share = far ? multiscatter.through : 1.0f - multiscatter.through;
    return GlassValue((far ? multiscatter.transmitted : multiscatter.reflected) * loss * cosine,
                      multiscatter.chance * share * cosine * InversePi);
}

// `choice`: uniform.
inline vec3 sample_glass_multiscatter(IN(GlassMultiscatter) multiscatter, float choice, vec2 u) {
    const vec3 w = sample_cosine_hemisphere(u);
    return choice < multiscatter.through ? vec3(w.x, w.y, -w.z) : w;
}

SHADING_END

#endif
