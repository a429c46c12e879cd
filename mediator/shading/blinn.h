#ifndef TESSERA_MEDIATOR_SHADING_BLINN_H
#define TESSERA_MEDIATOR_SHADING_BLINN_H

#include "mediator/shading/microfacets.h"

// Blinn's microfacets (1977), with two exponents as Ashikhmin and Shirley's (2000):
//   D(h) = sqrt((eu + 2)(ev + 2)) / (2 pi) x cos(h)^(eu cos^2 phi + ev sin^2 phi)
// whose projected areas sum to 1. The facets are walls of V-shaped cavities: their visible fraction is known
// for any D, min(1, 2 cos(h) cos(w) / (w . h)), and conserves energy (Heitz and d'Eon 2014). Light that hits
// the other wall is lost. Directions as in microfacets.h.
SHADING_BEGIN

// 1 - cos^2 of the half vector; by its x and y, since 1 - z^2 cancels where exponents are high.
inline float sine2_of(vec3 h) {
    return h.x * h.x + h.y * h.y;
}

// Logarithm of the cosine, by the squared sine. Below 0.1 as a series (-1/2 (s + s^2/2 + ...), cut at 1e-8 of
// it): the logarithm of a cosine near 1 is lost in its rounding.
inline float logarithm_of_cosine(float sine2, float cosine) {
    if (sine2 > 0.1f) return logarithm(cosine);
    const float sum =
        1.0f +
        sine2 * (0.5f +
                 sine2 * (1.0f / 3.0f +
                          sine2 * (0.25f + sine2 * (0.2f + sine2 * (1.0f / 6.0f + sine2 * (1.0f / 7.0f))))));
    return -0.5f * sine2 * sum;
}

// 1 - e^-x for x >= 0. Below 0.1 as a series, cut at 2e-8 of it.
inline float one_minus_exponential(float x) {
    if (x > 0.1f) return 1.0f - exponential(-x);
    return x * (1.0f - x * 0.5f * (1.0f - x * (1.0f / 3.0f) * (1.0f - x * 0.25f * (1.0f - x * 0.2f))));
}

inline float blinn_distribution(vec3 h, vec2 exponents) {
    const float sine2 = sine2_of(h);
    if (!(h.z > 0.0f)) return 0.0f;
    const float exponent =
        sine2 > 0.0f ? (exponents.x * h.x * h.x + exponents.y * h.y * h.y) / sine2 : exponents.x;
    const float scale = sqrt((exponents.x + 2.0f) * (exponents.y + 2.0f)) * (0.5f * InversePi);
    return scale * exponential(exponent * logarithm_of_cosine(sine2, h.z));
}

// Fraction of the facets with normal h that is visible from w.
inline float cavity_visibility(vec3 w, vec3 h) {
    const float facing = dot(w, h);
    if (!(facing > 0.0f)) return 0.0f;
    return lesser_of(1.0f, 2.0f * h.z * w.z / facing);
}

// Half vectors in proportion to the facets' visible area from `wo`: a facet by D, or the other wall of its
// cavity. `choice` in [0, 1).
inline vec3 sample_blinn_normal(vec3 wo, vec2 exponents, float choice, vec2 u) {
    const float turn = 2.0f * Pi * u.x;
    const float x = sqrt(exponents.y + 2.0f) * cosine(turn), y = sqrt(exponents.x + 2.0f) * sine(turn);
    const float length2 = x * x + y * y;
    const float exponent = (exponents.x * x * x + exponents.y * y * y) / length2;
    // cos = (1 - u)^(1 / (e + 2)); 1 - u is never 0.
    const float part = -logarithm(1.0f - u.y) / (exponent + 2.0f);
    const float sine_h = sqrt(one_minus_exponential(2.0f * part) / length2);
    const vec3 h = vec3(x * sine_h, y * sine_h, exponential(-part));
    const vec3 other = vec3(-h.x, -h.y, h.z);
    const float seen = greater_of(dot(wo, h), 0.0f), other_seen = greater_of(dot(wo, other), 0.0f);
    return choice * (seen + other_seen) < seen ? h : other;
}

// Facets in microfacets.h.
inline Facets blinn_at(vec3 wo, vec3 wi, vec3 h, vec2 exponents) {
    const float density = blinn_distribution(h, exponents) / (4.0f * wo.z);
    const float seen = cavity_visibility(wo, h);
    return Facets(density * lesser_of(seen, cavity_visibility(wi, h)), density * seen);
}

SHADING_END

#endif
