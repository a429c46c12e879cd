#ifndef TESSERA_TESTS_SHADING_OUTPUTS_H
#define TESSERA_TESTS_SHADING_OUTPUTS_H

#include "mediator/shading/maths.h"
#include "mediator/shading/perfect_specular.h"
#include "mediator/shading/sampling.h"

// Collects the results of the functions of functions/*.inc, in C++ and in shaders. Scene records:
// scene_puts.h.
SHADING_BEGIN

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
inline void put(INOUT(Outputs) y, IN(SampleSet) value) {
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
// Cosines of phases, offset by the size of their terms.
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
inline void put(INOUT(Outputs) y, IN(GlassPlace) value) {
    put(y, float(value.row) + vec2(value.between_roughnesses, value.between_indices));
}
// Of differences from 1.
inline void put(INOUT(Outputs) y, IN(GlassMultiscatter) value) {
    put(y, 1.0f + value.reflected);
    put(y, 1.0f + value.transmitted);
    put(y, 1.0f + value.chance);
}
inline void put(INOUT(Outputs) y, IN(PerfectPart) value) {
    put(y, value.reflection);
    put(y, value.transmission);
    put(y, value.eta);
    put(y, value.blend);
}
inline void put(INOUT(Outputs) y, IN(PerfectFractions) value) {
    put(y, 1.0f + value.reflected);
    put(y, 1.0f + value.refracted);
}
inline void put(INOUT(Outputs) y, IN(SurfaceShaderLobes) value) {
    put(y, value.diffuse);
    put(y, value.glossy);
    put(y, value.exponents);
    put(y, value.glossy_chance);
    put(y, 1.0f + value.left);  // a difference from 1
}
inline void put(INOUT(Outputs) y, IN(Bsdf) value) {
    put(y, value.lobes);
    if ((value.lobes & FeatureSurfaceShader) != 0u) {
        put(y, value.surface_shader);
        put(y, 1.0f + value.reflectance);
        return;
    }
    put(y, value.diffuse);
    put(y, value.f0);
    put(y, value.f90);
    put(y, vec2(value.base_f0, value.base_f90));
    put(y, vec2(value.dielectric, value.metal));
    put(y, value.has_facets);
    put(y, value.alpha);
    put(y, value.roughness);
    put(y, value.multiscatter);
    put(y, vec3(value.base_multiscatter, value.multiscatter_out, value.base_out));  // differences from 1
    put(y, value.glass_fraction);
    if ((value.lobes & FeatureRoughGlass) != 0u) put(y, value.glass_multiscatter);
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
inline void put(INOUT(Outputs) y, IN(MaterialSample) value) {
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
    put_next(y, value.refraction);  // weights of the same light
    put(y, value.reflected);
    put(y, value.refracted);
}
inline void put(INOUT(Outputs) y, IN(Refraction) value) {
    put(y, value.weight);
    put(y, value.direction);
}

SHADING_END

#endif
