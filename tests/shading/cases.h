#ifndef TESSERA_TESTS_SHADING_CASES_H
#define TESSERA_TESTS_SHADING_CASES_H

#include "mediator/shading/maths.h"
#include "mediator/shading/perfect_specular.h"
#include "mediator/shading/sampler.h"
#include "mediator/shading/sampling.h"
#include "tests/shading/outputs.h"

// Arguments for the functions of functions/*.inc, in C++ and in shaders. Those that need a scene:
// test_scene.h.
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

// Denser than air: with nearly equal indices the result at grazing angles depends on the last bit of the
// index.
inline ThinFilm film_of(IN(Inputs) x) {
    return make_film(0.2f + 0.8f * x.u.x, 0.5f + 0.5f * x.metallic, 1.1f + 1.5f * x.u.y,
                     50.0f + 800.0f * x.v.x);
}

// A material with all lobes, and the boundary of glass; each half of the inputs with its own side.
inline MaterialSample material_sample_of(IN(Inputs) x) {
    MaterialSample material_sample = default_material_sample(x.color, x.metallic, x.roughness, x.transmission,
                                                             x.index, x.c % 2u == 0u ? x.eta : x.index);
    material_sample.specular = 0.5f + 0.5f * x.metallic;
    material_sample.specular_color = 0.5f + x.light;
    material_sample.alpha = vec2(greater_of(material_sample.alpha.x, x.u.x * 0.5f), material_sample.alpha.y);
    material_sample.lobes = (x.a & ExtraLobes);
    material_sample.thin = x.d % 3u == 0u ? 1u : 0u;
    material_sample.coat = x.u.y;
    material_sample.coat_roughness = x.roughness;
    material_sample.coat_normal = unit_vector(vec3(0.2f * x.x, 0.1f, 1.0f));
    material_sample.sheen_color = x.light;
    material_sample.sheen_roughness = x.roughness;
    if ((material_sample.lobes & FeatureIridescence) != 0u) material_sample.film = film_of(x);
    return material_sample;
}
inline Mixture mixture_of(IN(Inputs) x) {
    return make_mixture(material_sample_of(x));
}
inline RoughGlass boundary_of(IN(Inputs) x) {
    const Interface face = interface_of(material_sample_of(x));
    const float eta = greater_of(x.eta, 0.4f);
    return RoughGlass(x.color, is_boundary(eta) ? eta : 1.5f, face.f0, face.f90, vec2(x.alpha, 0.5f),
                      x.d % 2u, x.c % 4u == 0u ? film_of(x) : no_film());
}
inline RoughGlass isotropic_boundary_of(IN(Inputs) x) {
    RoughGlass glass = boundary_of(x);
    glass.alpha = vec2(x.alpha);
    return glass;
}
inline GlassMultiscatter glass_multiscatter_of(FloatArray energy, IN(Inputs) x) {
    return glass_multiscatter(energy, isotropic_boundary_of(x), x.roughness, x.wo.z);
}
// Differences from 1.
inline vec4 broad_glass_of(FloatArray energy, IN(Inputs) x) {
    const GlassValue found =
        evaluate_glass_multiscatter(energy, isotropic_boundary_of(x), glass_multiscatter_of(energy, x),
                                    x.roughness, x.c % 2u == 0u ? x.wi : -x.wi);
    return 1.0f + vec4(found.value, found.pdf);
}
inline PerfectPart perfect_of(IN(Inputs) x) {
    return PerfectPart(0.6f * x.color, x.light, vec3(greater_of(x.eta, 0.4f), 1.2f, x.index + 0.1f), x.u.x);
}
inline vec2 exponents_of(IN(Inputs) x) {
    return vec2(1024.0f * x.roughness, 16.0f);
}
inline SurfaceShaderLobes shader_of(IN(Inputs) x) {
    return make_shader_lobes(x.color, x.light, exponents_of(x), perfect_of(x), x.wo.z);
}
inline Bsdf shader_bsdf_of(IN(Inputs) x) {
    Bsdf bsdf;
    fill_shader_bsdf(bsdf, shader_of(x));
    return bsdf;
}
// A ray direction that arrives on the side of x.n.
inline vec3 arriving_at(IN(Inputs) x) {
    return dot(x.wi, x.n) < 0.0f ? x.wi : -x.wi;
}
inline Bsdf layered_bsdf_of(FloatArray energy, IN(Inputs) x) {
    MaterialSample material_sample = material_sample_of(x);
    material_sample.lobes |= FeatureCoat | FeatureSheen;
    Bsdf bsdf;
    fill_bsdf(bsdf, energy, material_sample, mixture_of(x), x.wo);
    return bsdf;
}
inline Bsdf bsdf_of(FloatArray energy, IN(Inputs) x) {
    Bsdf bsdf;
    fill_bsdf(bsdf, energy, material_sample_of(x), mixture_of(x), x.wo);
    return bsdf;
}

SHADING_END

#endif
