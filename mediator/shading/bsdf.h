#ifndef TESSERA_MEDIATOR_SHADING_BSDF_H
#define TESSERA_MEDIATOR_SHADING_BSDF_H

#include "mediator/shading/glass_multiscatter.h"
#include "mediator/shading/phase.h"
#include "mediator/shading/sheen.h"
#include "mediator/shading/surface_shader_lobes.h"

// The surface model: a set of lobes that both material models map to. All directions are in the shading
// frame (z = normal) and point away from the surface. From the outside in:
//   sheen     fibres (sheen.h) over all the rest
//   coat      GGX with Schlick's Fresnel, F0 = 0.04, with its own normal
//   specular  GGX, height-correlated Smith, Schlick's Fresnel: metal and dielectric in one lobe; multiple
//             scattering between facets is compensated by an additional broad lobe (Kulla and Conty 2017)
//   diffuse   base colour / pi x (1 - S(i)) (1 - S(o)) / (1 - mean S), S(w) = albedo of the dielectric
//             interface for direction w (Kelemen and Szirmay-Kalos 2001): conserves energy for white
//   glass     rough boundary of two dielectrics, or of a thin wall, with multiple scattering between facets
//             as a broad lobe on each side (glass_multiscatter.h)
// A thin film changes the Fresnel term of specular and glass (thin_film.h); S is then an upper bound. A layer
// transmits the smaller of its transmittances for wi and wo. Every lobe is reciprocal; the sum conserves
// energy. The lobes of CommonSurfaceShader are others, in surface_shader_lobes.h: a surface has those or
// these. Perfect mirrors, smooth glass and smooth interfaces over a diffuse base have no density and are in
// perfect_specular.h; a material is a mixture of both kinds.
SHADING_BEGIN

// Rare lobes, as feature bits (records.h).
inline constexpr uint ExtraLobes = FeatureCoat | FeatureSheen | FeatureRoughGlass | FeatureIridescence;

inline constexpr float CoatF0 = 0.04f;

// A material evaluated at a point: its factors times its textures.
struct MaterialSample {
    vec3 base_color;
    float metallic;
    vec2 alpha;  // roughness along x and y, perceptual roughness squared
    float transmission;
    float index_of_refraction;
    float eta;  // far side / this side; 0: infinite
    float specular;
    vec3 specular_color;
    FeatureBits lobes;  // of ExtraLobes, those that may occur
    uint thin;          // thin-walled: transmitted light goes straight on
    float coat;
    float coat_roughness;
    vec3 coat_normal;
    vec3 sheen_color;
    float sheen_roughness;
    ThinFilm film;  // of FeatureIridescence
};

inline MaterialSample default_material_sample(vec3 base_color, float metallic, float roughness,
                                              float transmission, float index_of_refraction, float eta) {
    return MaterialSample(base_color, metallic, vec2(roughness * roughness), transmission,
                          index_of_refraction, eta, 1.0f, vec3(1.0f), 0u, 0u, 0.0f, 0.0f,
                          vec3(0.0f, 0.0f, 1.0f), vec3(0.0f), 0.0f, no_film());
}

// The components of a surface, as fractions that sum to 1. This file implements metal (rough), dielectric
// (opaque) and rough glass.
struct Mixture {
    float metal, dielectric, rough_glass;
    float mirror, glass;
};

// Exactly 1 if there is neither mirror nor glass.
inline float rough_fraction(IN(Mixture) mixture) {
    return 1.0f - mixture.mirror - mixture.glass;
}

inline bool is_smooth(float alpha) {
    return alpha <= MinAlpha;
}

// All of the surface's own facets; the coat has its own.
inline bool has_smooth_facets(IN(MaterialSample) material_sample) {
    return is_smooth(greater_of(material_sample.alpha.x, material_sample.alpha.y));
}

inline Mixture make_mixture(IN(MaterialSample) material_sample) {
    const float opaque = 1.0f - material_sample.metallic;
    Mixture mixture = Mixture(material_sample.metallic, opaque, 0.0f, 0.0f, 0.0f);
    const bool mirror = has_smooth_facets(material_sample);
    if (material_sample.transmission > 0.0f) {
        const float glass = opaque * material_sample.transmission;
        const bool clear = mirror || material_sample.eta == 0.0f || !is_boundary(material_sample.eta);
        mixture.glass = clear ? glass : 0.0f;
        mixture.rough_glass = clear ? 0.0f : glass;
        mixture.dielectric = opaque * (1.0f - material_sample.transmission);
    }
    if (mirror) {
        mixture.mirror = material_sample.metallic;
        mixture.metal = 0.0f;
    }
    return mixture;
}

// Schlick's Fresnel of the dielectric interface (KHR_materials_specular).
struct Interface {
    vec3 f0;
    float f90;
};

inline Interface interface_of(IN(MaterialSample) material_sample) {
    const float f0 = normal_reflectance(material_sample.index_of_refraction);
    const vec3 tinted = vec3(lesser_of(f0 * material_sample.specular_color.x, 1.0f),
                             lesser_of(f0 * material_sample.specular_color.y, 1.0f),
                             lesser_of(f0 * material_sample.specular_color.z, 1.0f));
    return Interface(tinted * material_sample.specular, f0 > 0.0f ? material_sample.specular : 0.0f);
}

struct Bsdf {
    FeatureBits lobes;        // of ExtraLobes
    vec3 diffuse;             // albedo of the base
    vec3 f0;                  // specular reflectance at normal incidence
    float f90;                // and at grazing incidence
    float base_f0, base_f90;  // of the interface above the diffuse lobe
    bool has_facets;          // the specular lobe has a density: it is rough, and not black
    float dielectric, metal;  // fractions of the components under a thin film (RoughGlass::film)
    vec2 alpha;
    float roughness;          // for the lookup of the specular lobe's albedo: that of the smoother direction
    vec3 multiscatter;        // multiple scattering between facets: value / ((1 - E(i)) (1 - E(o)) cos(i))
    float base_multiscatter;  // fraction of the interface's loss that multiple scattering returns
    float multiscatter_out;   // 1 - E(o), E = albedo of the specular lobe with perfectly reflecting facets
    float base_out;           // (1 - S(o)) / (1 - mean S) / pi
    float glass_fraction;     // of rough glass
    RoughGlass glass;         // its film is that of all the surface
    GlassMultiscatter glass_multiscatter;
    float coat, coat_alpha, coat_roughness, coat_out;  // strength; transmittance of the coat for wo
    vec3 coat_normal;
    vec3 sheen;
    float sheen_alpha, sheen_roughness, sheen_out;
    SurfaceShaderLobes surface_shader;
    float anisotropy;   // of a medium (phase.h)
    vec3 chances;       // sampling probabilities of diffuse, specular, coat; the rest is rough glass
    float reflectance;  // estimate of the albedo, reflection and transmission, as luminance
};

inline float glass_chance(IN(Bsdf) bsdf) {
    return greater_of(1.0f - bsdf.chances.x - bsdf.chances.y - bsdf.chances.z, 0.0f);
}

// A smooth coat is a perfect specular (perfect_specular.h).
inline bool has_rough_coat(IN(Bsdf) bsdf) {
    return (bsdf.lobes & FeatureCoat) != 0u && !is_smooth(bsdf.coat_alpha);
}

// ---- layers ----

// Transmittance of the dielectric interface: 1 - S.
inline float interface_transmittance(IN(Bsdf) bsdf, vec2 energy) {
    const float first = bsdf.base_f0 * energy.x + bsdf.base_f90 * energy.y;
    return greater_of(1.0f - first - bsdf.base_multiscatter * (1.0f - energy.x - energy.y), 0.0f);
}

// `cosine`: of the direction and the coat's normal, at least 0.
inline float coat_transmittance(FloatArray table, float coat, float roughness, float cosine) {
    const vec2 energy = lobe_energy(table, cosine, roughness);
    return 1.0f - coat * (CoatF0 * energy.x + energy.y);
}
inline float coat_passes(FloatArray table, IN(Bsdf) bsdf, vec3 w) {
    return coat_transmittance(table, bsdf.coat, bsdf.coat_roughness, abs(dot(w, bsdf.coat_normal)));
}

inline float sheen_transmittance(FloatArray table, vec3 sheen, float roughness, float cosine) {
    const float energy = sheen_energy(table, cosine, roughness);
    return 1.0f - largest(sheen) * lesser_of(energy, 1.0f);
}
inline float sheen_passes(FloatArray table, IN(Bsdf) bsdf, float cosine) {
    return sheen_transmittance(table, bsdf.sheen, bsdf.sheen_roughness, abs(cosine));
}

// Transmittance of all layers above base and glass, for light between wo and wi.
inline float layer_transmittance(FloatArray table, IN(Bsdf) bsdf, vec3 wi) {
    float transmittance = 1.0f;
    if ((bsdf.lobes & FeatureCoat) != 0u)
        transmittance = lesser_of(coat_passes(table, bsdf, wi), bsdf.coat_out);
    if ((bsdf.lobes & FeatureSheen) != 0u) {
        transmittance *= lesser_of(sheen_passes(table, bsdf, wi.z), bsdf.sheen_out);
    }
    return transmittance;
}

// ---- construction ----

COLD_NOINLINE inline vec3 thin_film_facet_fresnel(IN(Bsdf) bsdf, float cosine, vec3 plain) {
    const FilmLight light = film_light(bsdf.glass.film, cosine);
    const vec3 filmed = bsdf.dielectric * thin_film_dielectric(bsdf.glass.film, light, bsdf.glass.f0) +
                        bsdf.metal * thin_film_reflectances(light, bsdf.glass.tint);
    return plain + bsdf.glass.film.strength * (filmed - plain);
}

// Reflectance of the facets at this angle of incidence.
inline vec3 specular_fresnel(IN(Bsdf) bsdf, float cosine) {
    const vec3 plain = bsdf.f0 + (bsdf.f90 - bsdf.f0) * schlick_weight(cosine);
    if ((bsdf.lobes & FeatureIridescence) == 0u) return plain;
    return thin_film_facet_fresnel(bsdf, cosine, plain);
}

// multiscatter_reflectance: of the multiple scattering lobe for wo, as luminance.
inline void add_specular(INOUT(Bsdf) bsdf, OUT(float) multiscatter_reflectance, FloatArray table,
                         IN(Mixture) mixture, IN(Interface) face, vec3 base_color, float cos_out) {
    bsdf.f0 = face.f0 * mixture.dielectric + base_color * mixture.metal;
    bsdf.f90 = face.f90 * mixture.dielectric + mixture.metal;
    bsdf.base_f0 = largest(face.f0);
    bsdf.base_f90 = face.f90;
    bsdf.dielectric = mixture.dielectric;
    bsdf.metal = mixture.metal;
    vec3 mean_dielectric = face.f0 + (face.f90 - face.f0) * (1.0f / 21.0f);
    vec3 mean_metal = base_color + (1.0f - base_color) * (1.0f / 21.0f);
    if ((bsdf.lobes & FeatureIridescence) != 0u) {
        const float strength = bsdf.glass.film.strength;
        const FilmMean film = film_mean(bsdf.glass.film, face.f0, base_color);
        bsdf.base_f0 += strength * (film.f0 - bsdf.base_f0);
        bsdf.base_f90 += strength * (film.f90 - bsdf.base_f90);
        mean_dielectric += strength * (film.dielectric - mean_dielectric);
        mean_metal += strength * (film.metal - mean_metal);
    }
    bsdf.multiscatter = vec3(0.0f);
    bsdf.base_multiscatter = 0.0f;
    bsdf.multiscatter_out = 0.0f;
    bsdf.base_out = InversePi;
    multiscatter_reflectance = 0.0f;
    if (!(bsdf.f90 > 0.0f) && !(bsdf.base_f90 > 0.0f)) return;
    const vec2 energy = lobe_energy(table, cos_out, bsdf.roughness);
    const vec2 mean = mean_lobe_energy(table, bsdf.roughness);
    const float e = mean.x + mean.y;
    // The tables are for isotropic roughness: with anisotropy there is no compensation.
    const bool has_multiscatter = bsdf.alpha.x == bsdf.alpha.y && 1.0f - e > MinMultiscatter;
    bsdf.multiscatter_out = has_multiscatter ? 1.0f - energy.x - energy.y : 0.0f;
    bsdf.base_multiscatter =
        has_multiscatter
            ? multiscatter_fraction(lesser_of(mean_schlick(bsdf.base_f0, bsdf.base_f90), 1.0f), e)
            : 0.0f;
    const float passes = interface_transmittance(bsdf, mean);
    // Below, it is rounding error: the interface reflects everything.
    bsdf.base_out = passes > 1e-6f ? InversePi * interface_transmittance(bsdf, energy) / passes : 0.0f;
    if (!has_multiscatter) return;
    if (mixture.dielectric > 0.0f) {
        bsdf.multiscatter += mixture.dielectric * multiscatter_fractions(mean_dielectric, e);
    }
    if (mixture.metal > 0.0f) {
        bsdf.multiscatter += mixture.metal * multiscatter_fractions(mean_metal, e);
    }
    multiscatter_reflectance = luminance(bsdf.multiscatter) * bsdf.multiscatter_out;
    bsdf.multiscatter *= InversePi / (1.0f - e);
}

inline void add_layers(INOUT(Bsdf) bsdf, FloatArray table, IN(MaterialSample) material_sample, vec3 wo) {
    bsdf.coat = material_sample.coat;
    bsdf.coat_roughness = material_sample.coat_roughness;
    bsdf.coat_alpha = greater_of(material_sample.coat_roughness * material_sample.coat_roughness, MinAlpha);
    bsdf.coat_normal = material_sample.coat_normal;
    bsdf.sheen = material_sample.sheen_color;
    bsdf.sheen_roughness = material_sample.sheen_roughness;
    bsdf.sheen_alpha = sheen_alpha_of(material_sample.sheen_roughness);
    if ((bsdf.lobes & FeatureCoat) != 0u) bsdf.coat_out = coat_passes(table, bsdf, wo);
    if ((bsdf.lobes & FeatureSheen) != 0u) bsdf.sheen_out = sheen_passes(table, bsdf, wo.z);
}

// Sampling probabilities in proportion to the estimated albedos of the lobes for wo; never 0 or 1 if there
// are several lobes, so that no light is missed.
inline void choose_chances(INOUT(Bsdf) bsdf, FloatArray table, float multiscatter_reflectance,
                           float cos_out) {
    const float weight = schlick_weight(cos_out);
    const float below = bsdf.coat_out * bsdf.sheen_out;
    float specular = bsdf.has_facets ? luminance(specular_fresnel(bsdf, cos_out)) * below : 0.0f;
    // A film that reflects nothing at this angle may do so at others.
    if (bsdf.has_facets && (bsdf.lobes & FeatureIridescence) != 0u) specular = greater_of(specular, 1e-4f);
    float diffuse = luminance(bsdf.diffuse) * (1.0f - bsdf.base_f0) *
                    (1.0f - lesser_of(bsdf.base_f90, 1.0f) * weight) * below;
    diffuse += multiscatter_reflectance * below;  // as broad as the diffuse lobe, and sampled with it
    float coat = 0.0f, glass = 0.0f;
    if ((bsdf.lobes & FeatureSheen) != 0u) {
        diffuse += luminance(bsdf.sheen) * sheen_energy(table, cos_out, bsdf.sheen_roughness);
    }
    if ((bsdf.lobes & FeatureCoat) != 0u && !is_smooth(bsdf.coat_alpha)) {
        coat = (1.0f - bsdf.coat_out) * bsdf.sheen_out;
    }
    if ((bsdf.lobes & FeatureRoughGlass) != 0u) {
        glass = bsdf.glass_fraction * below;
    }
    const float sum = diffuse + specular + coat + glass;
    bsdf.reflectance = sum;
    const float least = 0.1f * sum;
    if (diffuse > 0.0f) diffuse = greater_of(diffuse, least);
    if (specular > 0.0f) specular = greater_of(specular, least);
    if (coat > 0.0f) coat = greater_of(coat, least);
    if (glass > 0.0f) glass = greater_of(glass, least);
    const float all = diffuse + specular + coat + glass;
    bsdf.chances = all > 0.0f ? vec3(diffuse, specular, coat) / all : vec3(1.0f, 0.0f, 0.0f);
}

inline void fill_bsdf(INOUT(Bsdf) bsdf, FloatArray table, IN(MaterialSample) material_sample,
                      IN(Mixture) mixture, vec3 wo) {
    bsdf.lobes = material_sample.lobes;
    const Interface face = interface_of(material_sample);
    bsdf.diffuse = material_sample.base_color * mixture.dielectric;
    bsdf.alpha =
        vec2(greater_of(material_sample.alpha.x, MinAlpha), greater_of(material_sample.alpha.y, MinAlpha));
    bsdf.roughness = sqrt(lesser_of(bsdf.alpha.x, bsdf.alpha.y));
    bsdf.glass_fraction = mixture.rough_glass;
    bsdf.glass = RoughGlass(material_sample.base_color, material_sample.eta, face.f0, face.f90, bsdf.alpha,
                            material_sample.thin, material_sample.film);
    float multiscatter_reflectance;
    add_specular(bsdf, multiscatter_reflectance, table, mixture, face, material_sample.base_color, wo.z);
    const bool reflects =
        bsdf.f90 > 0.0f || largest(bsdf.f0) > 0.0f || (bsdf.lobes & FeatureIridescence) != 0u;
    // A smooth face over a diffuse base is a perfect specular (surfaces.h), as smooth metal is (make_mixture).
    bsdf.has_facets = reflects && (mixture.metal > 0.0f || !has_smooth_facets(material_sample));
    if (!(mixture.rough_glass > 0.0f)) bsdf.lobes &= ~FeatureRoughGlass;
    bsdf.glass_multiscatter.chance = 0.0f;
    if ((bsdf.lobes & FeatureRoughGlass) != 0u)
        bsdf.glass_multiscatter = glass_multiscatter(table, bsdf.glass, bsdf.roughness, wo.z);
    bsdf.coat_out = 1.0f;
    bsdf.sheen_out = 1.0f;
    if ((bsdf.lobes & (FeatureCoat | FeatureSheen)) != 0u) add_layers(bsdf, table, material_sample, wo);
    choose_chances(bsdf, table, multiscatter_reflectance, wo.z);
}

inline void fill_shader_bsdf(INOUT(Bsdf) bsdf, IN(SurfaceShaderLobes) lobes) {
    bsdf.lobes = FeatureSurfaceShader;
    bsdf.surface_shader = lobes;
    bsdf.coat_out = 1.0f;
    bsdf.sheen_out = 1.0f;
    bsdf.reflectance = rough_reflectance(lobes);
}

// ---- light from wi to wo ----

inline void evaluate_base(INOUT(BsdfValue) result, FloatArray table, IN(Bsdf) bsdf, vec3 wo, vec3 wi) {
    const vec3 sum = wi + wo;
    const float length2 = dot(sum, sum);
    if (bsdf.has_facets && length2 > 0.0f) {
        const vec3 h = sum / sqrt(length2);
        const vec3 fresnel = specular_fresnel(bsdf, dot(wi, h));
        const Facets facets = facets_at(wo, wi, h, bsdf.alpha);
        result.value = fresnel * facets.value;
        result.pdf = bsdf.chances.y * facets.pdf;
    }
    float passes = InversePi;
    if (bsdf.base_f90 > 0.0f || bsdf.f90 > 0.0f) {
        const vec2 energy = lobe_energy(table, wi.z, bsdf.roughness);
        passes = bsdf.base_out * interface_transmittance(bsdf, energy);
        result.value += bsdf.multiscatter * (bsdf.multiscatter_out * (1.0f - energy.x - energy.y) * wi.z);
    }
    result.diffuse = bsdf.diffuse * (passes * wi.z);
    result.value += result.diffuse;
    result.pdf += bsdf.chances.x * wi.z * InversePi;
}

inline void add_coat(INOUT(BsdfValue) result, IN(Bsdf) bsdf, vec3 wo, vec3 wi) {
    const mat3 frame = frame_around(bsdf.coat_normal);
    const vec3 o = wo * frame, i = wi * frame;
    if (!(o.z > 0.0f) || !(i.z > 0.0f)) return;
    const vec3 sum = i + o;
    const float length2 = dot(sum, sum);
    if (!(length2 > 0.0f)) return;
    const vec3 h = sum / sqrt(length2);
    const Facets facets = facets_at(o, i, h, vec2(bsdf.coat_alpha));
    const float fresnel = CoatF0 + (1.0f - CoatF0) * schlick_weight(dot(i, h));
    result.value += vec3(bsdf.coat * fresnel * facets.value);
    result.pdf += bsdf.chances.z * facets.pdf;
}

inline void add_glass(INOUT(BsdfValue) result, FloatArray table, IN(Bsdf) bsdf, vec3 wo, vec3 wi) {
    GlassValue glass = evaluate_rough_glass(bsdf.glass, wo, wi);
    if (bsdf.glass_multiscatter.chance > 0.0f) {
        const GlassValue broad =
            evaluate_glass_multiscatter(table, bsdf.glass, bsdf.glass_multiscatter, bsdf.roughness, wi);
        glass.value += broad.value;
        glass.pdf = glass.pdf * (1.0f - bsdf.glass_multiscatter.chance) + broad.pdf;
    }
    result.value += glass.value * bsdf.glass_fraction;
    result.pdf += glass_chance(bsdf) * glass.pdf;
}

// Limits the albedo of sheen to 1 at grazing angles; by the smaller limit of both directions, so that it
// stays reciprocal.
inline float capped_sheen(FloatArray table, IN(Bsdf) bsdf, vec3 wo, vec3 wi) {
    const float most = greater_of(sheen_energy(table, wo.z, bsdf.sheen_roughness),
                                  sheen_energy(table, wi.z, bsdf.sheen_roughness));
    return sheen_value(wo, wi, bsdf.sheen_alpha) / greater_of(most, 1.0f);
}

inline BsdfValue evaluate_bsdf(FloatArray table, IN(Bsdf) bsdf, vec3 wo, vec3 wi) {
    BsdfValue result = BsdfValue(vec3(0.0f), 0.0f, vec3(0.0f));
    if ((bsdf.lobes & FeatureSurfaceShader) != 0u) {
        return wo.z > 0.0f && wi.z > 0.0f ? evaluate_shader(bsdf.surface_shader, wo, wi) : result;
    }
    if ((bsdf.lobes & FeatureMedia) != 0u) {
        const float value = phase_value(bsdf.anisotropy, wi);
        return BsdfValue(vec3(value), value, vec3(0.0f));
    }
    const bool glass = (bsdf.lobes & FeatureRoughGlass) != 0u;
    if (!(wo.z > 0.0f) || wi.z == 0.0f || (wi.z < 0.0f && !glass)) return result;
    if (wi.z > 0.0f) evaluate_base(result, table, bsdf, wo, wi);
    if (glass) add_glass(result, table, bsdf, wo, wi);
    if ((bsdf.lobes & (FeatureCoat | FeatureSheen)) == 0u) return result;
    const float passes = layer_transmittance(table, bsdf, wi);
    result.value *= passes;
    result.diffuse *= passes;
    if (!(wi.z > 0.0f)) return result;
    if (has_rough_coat(bsdf)) {
        BsdfValue coat = BsdfValue(vec3(0.0f), 0.0f, vec3(0.0f));
        add_coat(coat, bsdf, wo, wi);
        float under_sheen = 1.0f;
        if ((bsdf.lobes & FeatureSheen) != 0u) {
            under_sheen = lesser_of(sheen_passes(table, bsdf, wi.z), bsdf.sheen_out);
        }
        result.value += coat.value * under_sheen;
        result.pdf += coat.pdf;
    }
    if ((bsdf.lobes & FeatureSheen) != 0u) {
        result.value += bsdf.sheen * capped_sheen(table, bsdf, wo, wi);
    }
    return result;
}

// A direction, or none (0, 0, 0).
inline vec3 sample_bsdf(IN(Bsdf) bsdf, vec3 wo, float choice, vec2 u) {
    if ((bsdf.lobes & FeatureSurfaceShader) != 0u) return sample_shader(bsdf.surface_shader, wo, choice, u);
    if ((bsdf.lobes & FeatureMedia) != 0u) return sample_phase(bsdf.anisotropy, u);
    float first = bsdf.chances.y;
    if (choice < first) {
        const vec3 h = sample_visible_normal(wo, bsdf.alpha, u);
        return on_side(2.0f * dot(wo, h) * h - wo, 1.0f);
    }
    first += bsdf.chances.x;
    if (choice < first || (bsdf.lobes & (FeatureCoat | FeatureRoughGlass)) == 0u) {
        return sample_cosine_hemisphere(u);
    }
    if (has_rough_coat(bsdf)) {
        first += bsdf.chances.z;
        if (choice < first || (bsdf.lobes & FeatureRoughGlass) == 0u) {
            const mat3 frame = frame_around(bsdf.coat_normal);
            const vec3 o = wo * frame;
            if (!(o.z > 0.0f)) return vec3(0.0f);
            const vec3 h = sample_visible_normal(o, vec2(bsdf.coat_alpha), u);
            return on_side(frame * on_side(2.0f * dot(o, h) * h - o, 1.0f), 1.0f);
        }
    }
    const float rest = (choice - first) / greater_of(1.0f - first, 1e-6f);
    const float broad = bsdf.glass_multiscatter.chance;
    if (rest < broad) return sample_glass_multiscatter(bsdf.glass_multiscatter, rest / broad, u);
    return sample_rough_glass(bsdf.glass, wo, (rest - broad) / (1.0f - broad), u);
}

SHADING_END

#endif
