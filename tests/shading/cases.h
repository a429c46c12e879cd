#ifndef TESSERA_TESTS_SHADING_CASES_H
#define TESSERA_TESTS_SHADING_CASES_H

#include "mediator/shading/maths.h"
#include "mediator/shading/sampling.h"
#include "mediator/shading/sobol.h"
#include "mediator/shading/specular.h"
#include "tests/shading/puts.h"

// What the functions of functions/*.inc are called with, on both sides. What needs a scene is in world.h.
SHADING_BEGIN

struct Inputs {
    vec2 u;          // in the unit square
    vec2 v;          // likewise
    vec2 weights;    // barycentric
    vec3 wo;         // directions of the shading frame
    vec3 wi;         // likewise
    vec3 n;          // unit length
    vec3 vector;     // any length whose square is a float
    vec3 color;      // in the unit cube
    vec3 light;      // likewise
    float angle;     // up to 1e4 both ways
    float x;         // in [-1, 1]
    float positive;  // of any size
    float other;     // likewise
    float pdf;       // from 2^-10 to 2^10
    float exponent;  // in [-87, 88]
    float roughness;
    float metallic;
    float transmission;
    float alpha;
    float index;  // of refraction
    float eta;    // of two sides
    uint instance;
    uint a;  // any bits
    uint b;
    uint c;
    uint d;
};

// Denser than air: what light along a boundary of nearly nothing does is decided by the last bit of its
// index.
inline ThinFilm film_of(IN(Inputs) x) {
    return make_film(0.2f + 0.8f * x.u.x, 0.5f + 0.5f * x.metallic, 1.1f + 1.5f * x.u.y,
                     50.0f + 800.0f * x.v.x);
}

// A material with all lobes, and the boundary of glass; each half of the inputs with its own side.
inline Look look_of(IN(Inputs) x) {
    Look look = plain_look(x.color, x.metallic, x.roughness, x.transmission, x.index,
                           x.c % 2u == 0u ? x.eta : x.index);
    look.specular = 0.5f + 0.5f * x.metallic;
    look.specular_color = 0.5f + x.light;
    look.alpha = vec2(greater_of(look.alpha.x, x.u.x * 0.5f), look.alpha.y);
    look.lobes = (x.a & ExtraLobes);
    look.thin = x.d % 3u == 0u ? 1u : 0u;
    look.coat = x.u.y;
    look.coat_roughness = x.roughness;
    look.coat_normal = unit_vector(vec3(0.2f * x.x, 0.1f, 1.0f));
    look.sheen_color = x.light;
    look.sheen_roughness = x.roughness;
    if ((look.lobes & FeatureIridescence) != 0u) look.film = film_of(x);
    return look;
}
inline Mixture mixture_of(IN(Inputs) x) {
    return make_mixture(look_of(x));
}
inline RoughGlass boundary_of(IN(Inputs) x) {
    const Interface face = interface_of(look_of(x));
    const float eta = greater_of(x.eta, 0.4f);
    return RoughGlass(x.color, is_boundary(eta) ? eta : 1.5f, face.f0, face.f90, vec2(x.alpha, 0.5f),
                      x.d % 2u, x.c % 4u == 0u ? film_of(x) : no_film());
}
inline PerfectPart perfect_of(IN(Inputs) x) {
    return PerfectPart(0.6f * x.color, x.light, vec3(greater_of(x.eta, 0.4f), 1.2f, x.index + 0.1f), x.u.x);
}
inline vec2 exponents_of(IN(Inputs) x) {
    return vec2(1024.0f * x.roughness, 16.0f);
}
inline ShaderLobes shader_of(IN(Inputs) x) {
    return make_shader_lobes(x.color, x.light, exponents_of(x), perfect_of(x), x.wo.z);
}
inline Bsdf shader_bsdf_of(IN(Inputs) x) {
    Bsdf bsdf;
    fill_shader_bsdf(bsdf, shader_of(x));
    return bsdf;
}
// That comes to the side of x.n.
inline vec3 arriving_at(IN(Inputs) x) {
    return dot(x.wi, x.n) < 0.0f ? x.wi : -x.wi;
}
inline Bsdf layered_bsdf_of(FloatArray energy, IN(Inputs) x) {
    Look look = look_of(x);
    look.lobes |= FeatureCoat | FeatureSheen;
    Bsdf bsdf;
    fill_bsdf(bsdf, energy, look, mixture_of(x), x.wo);
    return bsdf;
}
inline Bsdf bsdf_of(FloatArray energy, IN(Inputs) x) {
    Bsdf bsdf;
    fill_bsdf(bsdf, energy, look_of(x), mixture_of(x), x.wo);
    return bsdf;
}

SHADING_END

#endif
