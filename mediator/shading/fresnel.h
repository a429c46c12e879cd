#ifndef TESSERA_MEDIATOR_SHADING_FRESNEL_H
#define TESSERA_MEDIATOR_SHADING_FRESNEL_H

#include "mediator/shading/maths.h"

// Reflectance of the boundary of two media. Cosines are those of the direction and the normal, in
// [0, 1].
SHADING_BEGIN

// Schlick's Fresnel (1994) is f0 + (f90 - f0) x this weight.
inline float schlick_weight(float cosine) {
    const float m = lesser_of(greater_of(1.0f - cosine, 0.0f), 1.0f);
    const float m2 = m * m;
    return m2 * m2 * m;
}

// Squared cosine on the far side, by Snell's law; not positive at total reflection. `sine2` is 1 - cosine^2,
// passed in because callers can compute it more accurately; eta as below, not 0. For eta >= 1 in a form that
// does not cancel at grazing angles.
inline float refracted_cosine2(float cosine, float sine2, float eta) {
    const float eta2 = eta * eta;
    return eta >= 1.0f ? ((eta - 1.0f) * (eta + 1.0f) + cosine * cosine) / eta2 : 1.0f - sine2 / eta2;
}

// Reflectance of a smooth boundary of two dielectrics for unpolarised light. eta = index of refraction on the
// far side / on this side; eta = 0: infinite.
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

// Reflectance at normal incidence; index 0: infinite.
inline float normal_reflectance(float index_of_refraction) {
    const float r =
        index_of_refraction == 0.0f ? 1.0f : (index_of_refraction - 1.0f) / (index_of_refraction + 1.0f);
    return r * r;
}

SHADING_END

#endif
