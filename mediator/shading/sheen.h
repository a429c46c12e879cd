#ifndef TESSERA_MEDIATOR_SHADING_SHEEN_H
#define TESSERA_MEDIATOR_SHADING_SHEEN_H

#include "mediator/shading/maths.h"

// Cloth: reflection by fibres that stand off the surface (Estevez and Kulla 2017, KHR_materials_sheen).
// Directions as in microfacets.h.
SHADING_BEGIN

// Below, the lobe at the horizon is narrower than the resolution of its albedo table.
inline constexpr float MinSheenRoughness = 0.07f;

inline float sheen_alpha_of(float roughness) {
    const float r = greater_of(roughness, MinSheenRoughness);
    return r * r;
}

// (2 + 1/alpha) sin^(1/alpha) / (2 pi) of the half vector.
inline float sheen_distribution(vec3 h, float alpha) {
    const float sine2 = lesser_of(h.x * h.x + h.y * h.y, 1.0f);
    const float exponent = 1.0f / alpha;
    return sine2 > 0.0f ? (2.0f + exponent) * (0.5f * InversePi) * power(sine2, 0.5f * exponent) : 0.0f;
}

// Their fit of the logarithm of Smith's lambda; t = (1 - alpha)^2 mixes the fits of rough and smooth.
inline float sheen_lambda_fit(float x, float t) {
    const float a = 21.5473f + (25.3245f - 21.5473f) * t, b = 3.82987f + (3.32435f - 3.82987f) * t;
    const float c = 0.19823f + (0.16801f - 0.19823f) * t, d = -1.97760f + (-1.27393f + 1.97760f) * t;
    const float e = -4.32054f + (-4.85967f + 4.32054f) * t;
    return a / (1.0f + b * (x > 0.0f ? power(x, c) : 0.0f)) + d * x + e;
}

inline float sheen_lambda(float cosine, float alpha) {
    const float t = (1.0f - alpha) * (1.0f - alpha);
    if (cosine < 0.5f) return exponential(sheen_lambda_fit(cosine, t));
    return exponential(2.0f * sheen_lambda_fit(0.5f, t) - sheen_lambda_fit(1.0f - cosine, t));
}

// Of white fibres, times the cosine of wi; both above the surface.
inline float sheen_value(vec3 wo, vec3 wi, float alpha) {
    const vec3 sum = wi + wo;
    const float length2 = dot(sum, sum);
    if (!(length2 > 0.0f)) return 0.0f;
    const float shadowing = 1.0f + sheen_lambda(wo.z, alpha) + sheen_lambda(wi.z, alpha);
    return sheen_distribution(sum / sqrt(length2), alpha) / (4.0f * wo.z * shadowing);
}

SHADING_END

#endif
