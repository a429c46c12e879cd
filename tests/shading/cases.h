#ifndef TESSERA_TESTS_SHADING_CASES_H
#define TESSERA_TESTS_SHADING_CASES_H

#include "mediator/shading/maths.h"
#include "mediator/shading/sampling.h"
#include "mediator/shading/sobol.h"
#include "mediator/shading/specular.h"

// What the functions of functions.inc are called with and where their results go, on both sides.
SHADING_BEGIN

struct Inputs {
    vec2 u, v;              // in the unit square
    vec3 wo, wi;            // directions of the shading frame
    vec3 n;                 // unit length
    vec3 vector;            // any length whose square is a float
    vec3 color;             // in the unit cube
    float angle;            // up to 1e4 both ways
    float x;                // in [-1, 1]
    float positive, other;  // of any size
    float exponent;         // in [-87, 88]
    float roughness, metallic, transmission, alpha;
    float index, eta;  // of refraction, and of two sides
    uint a, b, c, d;
};

struct Outputs {
    uint bits[24];
    uint count;
    uint starts;  // bit i: value i is the first of a vector
    uint exact;   // bit i: no bit of value i may differ
};

inline void put(INOUT(Outputs) y, uint value) {
    y.starts |= 1u << y.count;
    y.exact |= 1u << y.count;
    y.bits[y.count] = value;
    ++y.count;
}
inline void put(INOUT(Outputs) y, bool value) {
    put(y, value ? 1u : 0u);
}
inline void put_next(INOUT(Outputs) y, float value) {
    y.bits[y.count] = float_bits(value);
    ++y.count;
}
inline void put(INOUT(Outputs) y, float value) {
    y.starts |= 1u << y.count;
    put_next(y, value);
}
inline void put(INOUT(Outputs) y, vec2 value) {
    put(y, value.x);
    put_next(y, value.y);
}
inline void put(INOUT(Outputs) y, vec3 value) {
    put(y, value.x);
    put_next(y, value.y);
    put_next(y, value.z);
}
inline void put(INOUT(Outputs) y, IN(mat3) value) {
    put(y, value[0]);
    put(y, value[1]);
    put(y, value[2]);
}
inline void put(INOUT(Outputs) y, IN(ReducedAngle) value) {
    put(y, value.quarter & 3u);
    put(y, value.rest);
}
inline void put(INOUT(Outputs) y, IN(Sampler) value) {
    put(y, value.index);
    put(y, value.seed);
}
inline void put(INOUT(Outputs) y, IN(Mixture) value) {
    put(y, value.metal);
    put(y, value.dielectric);
    put(y, value.mirror);
    put(y, value.glass);
}
inline void put(INOUT(Outputs) y, IN(Bsdf) value) {
    put(y, value.diffuse);
    put(y, value.f0);
    put(y, value.coat_f0);
    put(y, value.f90);
    put(y, value.coat_f90);
    put(y, value.alpha);
    put(y, value.specular_share);
    put(y, value.reflectance);
}
inline void put(INOUT(Outputs) y, IN(BsdfValue) value) {
    put(y, value.value);
    put_next(y, value.diffuse.x);  // part of the value
    put_next(y, value.diffuse.y);
    put_next(y, value.diffuse.z);
    put(y, value.pdf);
}
inline void put(INOUT(Outputs) y, IN(Specular) value) {
    put(y, value.reflection);
    put_next(y, value.refraction.x);  // shares of the same light
    put_next(y, value.refraction.y);
    put_next(y, value.refraction.z);
    put(y, value.reflected);
    put(y, value.refracted);
}

inline Mixture mixture_of(IN(Inputs) x) {
    return make_mixture(x.metallic, x.roughness, x.transmission);
}
inline Bsdf bsdf_of(IN(Inputs) x) {
    return make_bsdf(x.color, mixture_of(x), x.roughness, x.index, x.wo.z);
}

// The function at place `function` of the table.
inline Outputs evaluate(uint function, IN(Inputs) x) {
    Outputs y;
    y.count = 0u;
    y.starts = 0u;
    y.exact = 0u;
    uint place = 0u;
#define FUNCTION(ordinary, edges, call)  \
    if (function == place) put(y, call); \
    ++place;
#include "tests/shading/functions.inc"
#undef FUNCTION
    return y;
}

SHADING_END

#endif
