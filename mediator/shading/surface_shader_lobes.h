#ifndef TESSERA_MEDIATOR_SHADING_SURFACE_SHADER_LOBES_H
#define TESSERA_MEDIATOR_SHADING_SURFACE_SHADER_LOBES_H

#include "mediator/shading/blinn.h"
#include "mediator/shading/bsdf_value.h"
#include "mediator/shading/fresnel.h"

// The lobes of X3D's CommonSurfaceShader (Schwenk 5.A.3), which defines fields but no equations:
//   diffuse   kd / pi
//   glossy    ks x Blinn's microfacets (blinn.h)
//   perfect   reflection kr (1 - b + b F), refraction kt (1 - b + b (1 - F)), F = Fresnel's equations for the
//             index of refraction of each channel, b = fresnelBlend; divided by their sum if that exceeds
//             1. No refraction at total reflection, independent of b.
// kd + ks is scaled to at most 1. Diffuse and glossy lobes are scaled by what the perfect ones transmit: the
// smaller of 1 - their sum for wi and for wo. So all lobes are reciprocal, and the sum conserves energy.
// Directions as in microfacets.h.
SHADING_BEGIN

struct PerfectPart {
    vec3 reflection;    // kr
    vec3 transmission;  // kt
    vec3 eta;           // far side / this side, for each channel
    float blend;        // b
};

struct PerfectFractions {
    vec3 reflected;
    vec3 refracted;
};

struct SurfaceShaderLobes {
    vec3 diffuse;         // kd
    vec3 glossy;          // ks
    vec2 exponents;       // of Blinn's distribution
    float glossy_chance;  // of being sampled
    PerfectPart perfect;
    vec3 left;  // transmittance of the perfect lobes for wo
};

inline bool is_perfect(IN(PerfectPart) part) {
    return largest(part.reflection) > 0.0f || largest(part.transmission) > 0.0f;
}

inline bool disperses(IN(PerfectPart) part) {
    return largest(part.transmission) > 0.0f && (part.eta.x != part.eta.y || part.eta.x != part.eta.z);
}

inline bool reflects_totally(float cosine, float eta) {
    return !(eta > 0.0f) ||
           (eta < 1.0f && !(refracted_cosine2(cosine, (1.0f - cosine) * (1.0f + cosine), eta) > 0.0f));
}

// x = reflected, y = refracted, of one colour channel.
inline vec2 perfect_fraction(float reflection, float transmission, float blend, float cosine, float eta) {
    const float fresnel = fresnel_dielectric(cosine, eta);
    const float reflected = reflection * (1.0f - blend * (1.0f - fresnel));
    const float refracted = reflects_totally(cosine, eta) ? 0.0f : transmission * (1.0f - blend * fresnel);
    return vec2(reflected, refracted) / greater_of(1.0f, reflected + refracted);
}

inline PerfectFractions perfect_fractions(IN(PerfectPart) part, float cosine) {
    const vec2 x = perfect_fraction(part.reflection.x, part.transmission.x, part.blend, cosine, part.eta.x);
    const vec2 y = perfect_fraction(part.reflection.y, part.transmission.y, part.blend, cosine, part.eta.y);
    const vec2 z = perfect_fraction(part.reflection.z, part.transmission.z, part.blend, cosine, part.eta.z);
    return PerfectFractions(vec3(x.x, y.x, z.x), vec3(x.y, y.y, z.y));
}

// What the perfect lobes transmit at this cosine.
inline vec3 perfect_transmittance(IN(PerfectPart) part, float cosine) {
    if (!is_perfect(part)) return vec3(1.0f);
    const PerfectFractions fractions = perfect_fractions(part, cosine);
    const vec3 rest = 1.0f - (fractions.reflected + fractions.refracted);
    return vec3(greater_of(rest.x, 0.0f), greater_of(rest.y, 0.0f), greater_of(rest.z, 0.0f));
}

// Of diffuse and glossy reflection.
inline float rough_reflectance(IN(SurfaceShaderLobes) lobes) {
    return luminance((lobes.diffuse + lobes.glossy) * lobes.left);
}

inline SurfaceShaderLobes make_shader_lobes(vec3 diffuse, vec3 glossy, vec2 exponents,
                                            IN(PerfectPart) perfect, float cos_out) {
    const float scale = 1.0f / greater_of(1.0f, largest(diffuse + glossy));
    const float kd = luminance(diffuse), ks = luminance(glossy);
    float chance = ks > 0.0f ? ks / (kd + ks) : 0.0f;
    if (chance > 0.0f && kd > 0.0f) chance = clamp(chance, 0.1f, 0.9f);
    return SurfaceShaderLobes(diffuse * scale, glossy * scale, exponents, chance, perfect,
                              perfect_transmittance(perfect, cos_out));
}

// Both directions above the surface.
inline BsdfValue evaluate_shader(IN(SurfaceShaderLobes) lobes, vec3 wo, vec3 wi) {
    const vec3 transmitted_in = perfect_transmittance(lobes.perfect, wi.z);
    const vec3 left =
        vec3(lesser_of(lobes.left.x, transmitted_in.x), lesser_of(lobes.left.y, transmitted_in.y),
             lesser_of(lobes.left.z, transmitted_in.z));
    const float cosine_pdf = wi.z * InversePi;
    const vec3 diffuse = lobes.diffuse * left * cosine_pdf;
    BsdfValue result = BsdfValue(diffuse, (1.0f - lobes.glossy_chance) * cosine_pdf, diffuse);
    const vec3 sum = wi + wo;
    const float length2 = dot(sum, sum);
    if (!(lobes.glossy_chance > 0.0f) || !(length2 > 0.0f)) return result;
    const Facets facets = blinn_at(wo, wi, sum / sqrt(length2), lobes.exponents);
    result.value += lobes.glossy * left * facets.value;
    result.pdf += lobes.glossy_chance * facets.pdf;
    return result;
}

// A direction above the surface, or none (0, 0, 0).
inline vec3 sample_shader(IN(SurfaceShaderLobes) lobes, vec3 wo, float choice, vec2 u) {
    if (!(choice < lobes.glossy_chance)) return sample_cosine_hemisphere(u);
    const vec3 h = sample_blinn_normal(wo, lobes.exponents, choice / lobes.glossy_chance, u);
    const vec3 wi = 2.0f * dot(wo, h) * h - wo;
    return wi.z > 0.0f ? wi : vec3(0.0f);
}

SHADING_END

#endif
