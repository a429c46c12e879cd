#ifndef TESSERA_TESTS_SHADING_CASES_H
#define TESSERA_TESTS_SHADING_CASES_H

#include "mediator/shading/maths.h"
#include "mediator/shading/sampling.h"
#include "mediator/shading/sobol.h"
#include "mediator/shading/specular.h"

// What the functions of functions/*.inc are called with and where their results go, on both sides. What needs
// a scene is in world.h.
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

struct Outputs {
    uint bits[64];  // as many as the masks have bits
    uint count;
    uvec2 starts;  // bit i: value i is the first of a vector
    uvec2 exact;   // bit i: no bit of value i may differ
};

inline Outputs no_outputs() {
    Outputs y;
    y.count = 0u;
    y.starts = uvec2(0u);
    y.exact = uvec2(0u);
    return y;
}

inline void put_next(INOUT(Outputs) y, float value) {
    y.bits[y.count] = float_bits(value);
    y.count += 1u;
}
inline void put_next(INOUT(Outputs) y, vec3 value) {
    put_next(y, value.x);
    put_next(y, value.y);
    put_next(y, value.z);
}
inline void start_vector(INOUT(Outputs) y) {
    const uint bit = 1u << (y.count & 31u);
    y.starts |= y.count < 32u ? uvec2(bit, 0u) : uvec2(0u, bit);
}
inline void put(INOUT(Outputs) y, uint value) {
    start_vector(y);
    const uint bit = 1u << (y.count & 31u);
    y.exact |= y.count < 32u ? uvec2(bit, 0u) : uvec2(0u, bit);
    y.bits[y.count] = value;
    y.count += 1u;
}
inline void put(INOUT(Outputs) y, int value) {
    put(y, uint(value));
}
inline void put(INOUT(Outputs) y, bool value) {
    put(y, value ? 1u : 0u);
}
inline void put(INOUT(Outputs) y, float value) {
    start_vector(y);
    put_next(y, value);
}
inline void put(INOUT(Outputs) y, vec2 value) {
    put(y, value.x);
    put_next(y, value.y);
}
inline void put(INOUT(Outputs) y, vec3 value) {
    start_vector(y);
    put_next(y, value);
}
inline void put(INOUT(Outputs) y, vec4 value) {
    put(y, vec3(value));
    put_next(y, value.w);
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
    put(y, value.rough_glass);
    put(y, value.mirror);
    put(y, value.glass);
}
inline void put(INOUT(Outputs) y, IN(Interface) value) {
    put(y, value.f0);
    put(y, value.f90);
}
inline void put(INOUT(Outputs) y, IN(ThinFilm) value) {
    put(y, value.strength);
    put(y, value.specular);
    put(y, value.index);
    put(y, value.thickness);
}
// Cosines of phases, beside their size.
inline void put(INOUT(Outputs) y, IN(FilmLight) value) {
    put(y, 1.0f + value.amplitude);
    put(y, 1.0f + value.reflectance);
    put(y, 1.0f + value.weight);
    put(y, 4.0f + value.once);
    put(y, 4.0f + value.twice);
}
inline void put(INOUT(Outputs) y, IN(FilmMean) value) {
    put(y, 1.0f + value.dielectric);
    put(y, 1.0f + value.metal);
    put(y, 1.0f + value.f0);
    put(y, 1.0f + value.f90);
}
inline void put(INOUT(Outputs) y, IN(RoughGlass) value) {
    put(y, value.tint);
    put(y, value.eta);
    put(y, value.f0);
    put(y, value.f90);
    put(y, value.alpha);
    put(y, value.thin);
    put(y, value.film);
}
inline void put(INOUT(Outputs) y, IN(Facets) value) {
    put(y, value.value);
    put(y, value.pdf);
}
inline void put(INOUT(Outputs) y, IN(GlassValue) value) {
    put(y, value.value);
    put(y, value.pdf);
}
inline void put(INOUT(Outputs) y, IN(PerfectPart) value) {
    put(y, value.reflection);
    put(y, value.transmission);
    put(y, value.eta);
    put(y, value.blend);
}
inline void put(INOUT(Outputs) y, IN(PerfectShares) value) {
    put(y, 1.0f + value.reflected);
    put(y, 1.0f + value.refracted);
}
inline void put(INOUT(Outputs) y, IN(ShaderLobes) value) {
    put(y, value.diffuse);
    put(y, value.glossy);
    put(y, value.exponents);
    put(y, value.glossy_chance);
    put(y, 1.0f + value.left);  // a difference from 1
}
inline void put(INOUT(Outputs) y, IN(Bsdf) value) {
    put(y, value.lobes);
    if ((value.lobes & FeatureShader) != 0u) {
        put(y, value.shader);
        put(y, 1.0f + value.reflectance);
        return;
    }
    put(y, value.diffuse);
    put(y, value.f0);
    put(y, value.f90);
    put(y, vec2(value.base_f0, value.base_f90));
    put(y, vec2(value.dielectric, value.metal));
    put(y, value.alpha);
    put(y, value.roughness);
    put(y, value.late);
    put(y, vec3(value.base_late, value.late_out, value.base_out));  // differences from 1
    put(y, value.glass_share);
    put(y, vec3(value.coat_out, value.sheen_out, 1.0f));
    put(y, value.chances);
    if ((value.lobes & (FeatureCoat | FeatureSheen)) != 0u) {
        put(y, value.coat);
        put(y, vec2(value.coat_alpha, value.coat_roughness));
        put(y, value.coat_normal);
        put(y, value.sheen);
        put(y, vec2(value.sheen_alpha, value.sheen_roughness));
    }
    put(y, value.reflectance);
}
inline void put(INOUT(Outputs) y, IN(Look) value) {
    put(y, value.base_color);
    put(y, value.metallic);
    put(y, value.alpha);
    put(y, value.transmission);
    put(y, vec2(value.index_of_refraction, value.eta));
    put(y, value.specular);
    put(y, value.specular_color);
    put(y, value.lobes);
    put(y, value.thin);
    put(y, vec2(value.coat, value.coat_roughness));
    put(y, value.coat_normal);
    put(y, value.sheen_color);
    put(y, value.sheen_roughness);
    put(y, value.film);
}
inline void put(INOUT(Outputs) y, IN(BsdfValue) value) {
    put(y, value.value);
    put_next(y, value.diffuse);  // part of the value
    put(y, value.pdf);
}
inline void put(INOUT(Outputs) y, IN(Specular) value) {
    put(y, value.reflection);
    put_next(y, value.refraction);  // shares of the same light
    put(y, value.reflected);
    put(y, value.refracted);
}
inline void put(INOUT(Outputs) y, IN(Refraction) value) {
    put(y, value.share);
    put(y, value.direction);
}

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
