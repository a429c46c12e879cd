#ifndef TESSERA_MEDIATOR_SHADING_BSDF_H
#define TESSERA_MEDIATOR_SHADING_BSDF_H

#include "mediator/shading/energy.h"
#include "mediator/shading/phase.h"
#include "mediator/shading/rough_glass.h"
#include "mediator/shading/shader_lobes.h"
#include "mediator/shading/sheen.h"

// The surface model: a set of lobes that both models of materials lower to. All directions are in the shading
// frame (z = normal) and point away from the surface. From the outside in:
//   sheen     fibres (sheen.h) over all the rest
//   coat      GGX with Schlick's Fresnel, F0 = 0.04, about a normal of its own
//   specular  GGX, height-correlated Smith, Schlick's Fresnel: metal and dielectric in one lobe; what facets
//             send to each other comes out as a broad lobe of its own (Kulla and Conty 2017)
//   diffuse   base colour / pi x (1 - S(i)) (1 - S(o)) / (1 - mean S), S(w) = what the dielectric interface
//             reflects of light from w (Kelemen and Szirmay-Kalos 2001): white reflects all that comes in
//   glass     rough boundary of two dielectrics, or of a thin wall; single scattering only
// A thin film changes the Fresnel of specular and glass (thin_film.h); S is then that of a bound.
// A layer passes the lesser of what it lets through on the way in and on the way out. Every lobe is
// reciprocal; the sum never reflects more than comes in.
// The lobes of CommonSurfaceShader are others, in shader_lobes.h: a surface has those or these.
// Perfect mirrors and smooth glass have no density and are in specular.h; a material is a mixture of both
// kinds.
SHADING_BEGIN

// Lobes that few surfaces have: bits of records.h's features.
inline constexpr uint ExtraLobes = FeatureCoat | FeatureSheen | FeatureRoughGlass | FeatureIridescence;

inline constexpr float CoatF0 = 0.04f;

// What a material is at a point: its factors times its textures.
struct Look {
    vec3 base_color;
    float metallic;
    vec2 alpha;  // roughness along x and y, perceptual roughness squared
    float transmission;
    float index_of_refraction;
    float eta;  // far side / this side; 0: without bound
    float specular;
    vec3 specular_color;
    FeatureBits lobes;  // of ExtraLobes, which may be there
    uint thin;          // walls: light goes straight on
    float coat;
    float coat_roughness;
    vec3 coat_normal;
    vec3 sheen_color;
    float sheen_roughness;
    ThinFilm film;  // of FeatureIridescence
};

inline Look plain_look(vec3 base_color, float metallic, float roughness, float transmission,
                       float index_of_refraction, float eta) {
    return Look(base_color, metallic, vec2(roughness * roughness), transmission, index_of_refraction, eta,
                1.0f, vec3(1.0f), 0u, 0u, 0.0f, 0.0f, vec3(0.0f, 0.0f, 1.0f), vec3(0.0f), 0.0f, no_film());
}

// What a surface consists of: shares that sum to 1. This file knows metal (rough), dielectric (opaque,
// coated) and glass (rough).
struct Mixture {
    float metal, dielectric, rough_glass;
    float mirror, glass;
};

// Exactly 1 where there is neither mirror nor glass.
inline float rough_share(IN(Mixture) mixture) {
    return 1.0f - mixture.mirror - mixture.glass;
}

inline bool is_smooth(float alpha) {
    return alpha <= MinAlpha;
}

inline Mixture make_mixture(IN(Look) look) {
    const float opaque = 1.0f - look.metallic;
    Mixture mixture = Mixture(look.metallic, opaque, 0.0f, 0.0f, 0.0f);
    const bool mirror = is_smooth(greater_of(look.alpha.x, look.alpha.y));
    if (look.transmission > 0.0f) {
        const float glass = opaque * look.transmission;
        const bool clear = mirror || look.eta == 0.0f || !is_boundary(look.eta);
        mixture.glass = clear ? glass : 0.0f;
        mixture.rough_glass = clear ? 0.0f : glass;
        mixture.dielectric = opaque * (1.0f - look.transmission);
    }
    if (mirror) {
        mixture.mirror = look.metallic;
        mixture.metal = 0.0f;
    }
    return mixture;
}

// Schlick's Fresnel of the dielectric interface (KHR_materials_specular).
struct Interface {
    vec3 f0;
    float f90;
};

inline Interface interface_of(IN(Look) look) {
    const float f0 = normal_reflectance(look.index_of_refraction);
    const vec3 tinted =
        vec3(lesser_of(f0 * look.specular_color.x, 1.0f), lesser_of(f0 * look.specular_color.y, 1.0f),
             lesser_of(f0 * look.specular_color.z, 1.0f));
    return Interface(tinted * look.specular, f0 > 0.0f ? look.specular : 0.0f);
}

struct Bsdf {
    FeatureBits lobes;        // of ExtraLobes
    vec3 diffuse;             // albedo of the base
    vec3 f0;                  // specular reflectance at normal incidence
    float f90;                // and at grazing: of all of its share
    float base_f0, base_f90;  // of the interface above the diffuse lobe
    float dielectric, metal;  // shares of what is under a film, which the glass knows
    vec2 alpha;
    float roughness;    // by which the specular lobe's energy is looked up: of the smoother direction
    vec3 late;          // specular light from facet to facet: value / ((1 - E(i)) (1 - E(o)) cos(i))
    float base_late;    // share of what the interface loses at first that it reflects later
    float late_out;     // 1 - E(o), E = what the specular lobe would reflect if facets reflected all
    float base_out;     // (1 - S(o)) / (1 - mean S) / pi
    float glass_share;  // of rough glass
    RoughGlass glass;   // its film is that of all the surface
    float coat, coat_alpha, coat_roughness, coat_out;  // share; what the coat lets pass to wo
    vec3 coat_normal;
    vec3 sheen;
    float sheen_alpha, sheen_roughness, sheen_out;
    ShaderLobes shader;
    float anisotropy;   // of a medium (phase.h)
    vec3 chances;       // of sampling diffuse, specular, coat; the rest is rough glass
    float reflectance;  // estimate of all that is reflected and let through, as luminance
};

inline float glass_chance(IN(Bsdf) bsdf) {
    return greater_of(1.0f - bsdf.chances.x - bsdf.chances.y - bsdf.chances.z, 0.0f);
}

// A smooth coat is in specular.h.
inline bool has_rough_coat(IN(Bsdf) bsdf) {
    return (bsdf.lobes & FeatureCoat) != 0u && !is_smooth(bsdf.coat_alpha);
}

// ---- layers ----

// Of the dielectric interface: (1 - S).
inline float passes_interface(IN(Bsdf) bsdf, vec2 energy) {
    const float first = bsdf.base_f0 * energy.x + bsdf.base_f90 * energy.y;
    return greater_of(1.0f - first - bsdf.base_late * (1.0f - energy.x - energy.y), 0.0f);
}

inline float passes_coat(FloatArray table, IN(Bsdf) bsdf, vec3 w) {
    const vec2 energy = lobe_energy(table, abs(dot(w, bsdf.coat_normal)), bsdf.coat_roughness);
    return 1.0f - bsdf.coat * (CoatF0 * energy.x + energy.y);
}

inline float passes_sheen(FloatArray table, IN(Bsdf) bsdf, float cosine) {
    const float energy = sheen_energy(table, abs(cosine), bsdf.sheen_roughness);
    return 1.0f - largest(bsdf.sheen) * lesser_of(energy, 1.0f);
}

// Of all layers above base and glass, for light between wo and wi.
inline float passes_layers(FloatArray table, IN(Bsdf) bsdf, vec3 wi) {
    float share = 1.0f;
    if ((bsdf.lobes & FeatureCoat) != 0u) share = lesser_of(passes_coat(table, bsdf, wi), bsdf.coat_out);
    if ((bsdf.lobes & FeatureSheen) != 0u) {
        share *= lesser_of(passes_sheen(table, bsdf, wi.z), bsdf.sheen_out);
    }
    return share;
}

// ---- making ----

// Where facets send less to each other than this share, in the mean over all directions, that light is left
// out: it leaves along the surface, where no other lobe would look for it.
inline constexpr float LeastLate = 1e-3f;

SELDOM inline vec3 filmed_facets(IN(Bsdf) bsdf, float cosine, vec3 plain) {
    const FilmLight light = film_light(bsdf.glass.film, cosine);
    const vec3 filmed = bsdf.dielectric * filmed_dielectric(bsdf.glass.film, light, bsdf.glass.f0) +
                        bsdf.metal * film_reflectances(light, bsdf.glass.tint);
    return plain + bsdf.glass.film.strength * (filmed - plain);
}

// Reflectance of the facets, to light under this angle.
inline vec3 specular_fresnel(IN(Bsdf) bsdf, float cosine) {
    const vec3 plain = bsdf.f0 + (bsdf.f90 - bsdf.f0) * schlick_weight(cosine);
    if ((bsdf.lobes & FeatureIridescence) == 0u) return plain;
    return filmed_facets(bsdf, cosine, plain);
}

// late_reflectance: what the lobe's late light adds to what is reflected to wo, as luminance.
inline void add_specular(INOUT(Bsdf) bsdf, OUT(float) late_reflectance, FloatArray table, IN(Mixture) mixture,
                         IN(Interface) face, vec3 base_color, float cos_out) {
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
    bsdf.late = vec3(0.0f);
    bsdf.base_late = 0.0f;
    bsdf.late_out = 0.0f;
    bsdf.base_out = InversePi;
    late_reflectance = 0.0f;
    if (!(bsdf.f90 > 0.0f) && !(bsdf.base_f90 > 0.0f)) return;
    const vec2 energy = lobe_energy(table, cos_out, bsdf.roughness);
    const vec2 mean = mean_lobe_energy(table, bsdf.roughness);
    const float e = mean.x + mean.y;
    // The tables know of one roughness: with two, that light stays lost.
    const bool has_late = bsdf.alpha.x == bsdf.alpha.y && 1.0f - e > LeastLate;
    bsdf.late_out = has_late ? 1.0f - energy.x - energy.y : 0.0f;
    bsdf.base_late =
        has_late ? late_share(lesser_of(mean_schlick(bsdf.base_f0, bsdf.base_f90), 1.0f), e) : 0.0f;
    const float passes = passes_interface(bsdf, mean);
    // Below, it is rounding: the interface reflects all.
    bsdf.base_out = passes > 1e-6f ? InversePi * passes_interface(bsdf, energy) / passes : 0.0f;
    if (!has_late) return;
    if (mixture.dielectric > 0.0f) {
        bsdf.late += mixture.dielectric * late_shares(mean_dielectric, e);
    }
    if (mixture.metal > 0.0f) {
        bsdf.late += mixture.metal * late_shares(mean_metal, e);
    }
    late_reflectance = luminance(bsdf.late) * bsdf.late_out;
    bsdf.late *= InversePi / (1.0f - e);
}

inline void add_layers(INOUT(Bsdf) bsdf, FloatArray table, IN(Look) look, vec3 wo) {
    bsdf.coat = look.coat;
    bsdf.coat_roughness = look.coat_roughness;
    bsdf.coat_alpha = greater_of(look.coat_roughness * look.coat_roughness, MinAlpha);
    bsdf.coat_normal = look.coat_normal;
    bsdf.sheen = look.sheen_color;
    bsdf.sheen_roughness = look.sheen_roughness;
    bsdf.sheen_alpha = sheen_alpha_of(look.sheen_roughness);
    if ((bsdf.lobes & FeatureCoat) != 0u) bsdf.coat_out = passes_coat(table, bsdf, wo);
    if ((bsdf.lobes & FeatureSheen) != 0u) bsdf.sheen_out = passes_sheen(table, bsdf, wo.z);
}

// In proportion to what the lobes reflect of light to wo, so far as that can be told; never 0 or 1 while
// several are there, so that no light is out of reach.
inline void choose_chances(INOUT(Bsdf) bsdf, FloatArray table, float late_reflectance, float cos_out) {
    const float weight = schlick_weight(cos_out);
    const float below = bsdf.coat_out * bsdf.sheen_out;
    float specular = luminance(specular_fresnel(bsdf, cos_out)) * below;
    // A film that reflects nothing here does so elsewhere.
    if ((bsdf.lobes & FeatureIridescence) != 0u) specular = greater_of(specular, 1e-4f);
    float diffuse = luminance(bsdf.diffuse) * (1.0f - bsdf.base_f0) *
                    (1.0f - lesser_of(bsdf.base_f90, 1.0f) * weight) * below;
    diffuse += late_reflectance * below;  // as broad as the diffuse lobe, and found with it
    float coat = 0.0f, glass = 0.0f;
    if ((bsdf.lobes & FeatureSheen) != 0u) {
        diffuse += luminance(bsdf.sheen) * sheen_energy(table, cos_out, bsdf.sheen_roughness);
    }
    if ((bsdf.lobes & FeatureCoat) != 0u && !is_smooth(bsdf.coat_alpha)) {
        coat = (1.0f - bsdf.coat_out) * bsdf.sheen_out;
    }
    if ((bsdf.lobes & FeatureRoughGlass) != 0u) {
        glass = bsdf.glass_share * below;
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

inline void fill_bsdf(INOUT(Bsdf) bsdf, FloatArray table, IN(Look) look, IN(Mixture) mixture, vec3 wo) {
    bsdf.lobes = look.lobes;
    const Interface face = interface_of(look);
    bsdf.diffuse = look.base_color * mixture.dielectric;
    bsdf.alpha = vec2(greater_of(look.alpha.x, MinAlpha), greater_of(look.alpha.y, MinAlpha));
    bsdf.roughness = sqrt(lesser_of(bsdf.alpha.x, bsdf.alpha.y));
    bsdf.glass_share = mixture.rough_glass;
    bsdf.glass = RoughGlass(look.base_color, look.eta, face.f0, face.f90, bsdf.alpha, look.thin, look.film);
    float late_reflectance;
    add_specular(bsdf, late_reflectance, table, mixture, face, look.base_color, wo.z);
    if (!(mixture.rough_glass > 0.0f)) bsdf.lobes &= ~FeatureRoughGlass;
    bsdf.coat_out = 1.0f;
    bsdf.sheen_out = 1.0f;
    if ((bsdf.lobes & (FeatureCoat | FeatureSheen)) != 0u) add_layers(bsdf, table, look, wo);
    choose_chances(bsdf, table, late_reflectance, wo.z);
}

inline void fill_shader_bsdf(INOUT(Bsdf) bsdf, IN(ShaderLobes) lobes) {
    bsdf.lobes = FeatureShader;
    bsdf.shader = lobes;
    bsdf.coat_out = 1.0f;
    bsdf.sheen_out = 1.0f;
    bsdf.reflectance = rough_reflectance(lobes);
}

// ---- light from wi to wo ----

inline void evaluate_base(INOUT(BsdfValue) result, FloatArray table, IN(Bsdf) bsdf, vec3 wo, vec3 wi) {
    const vec3 sum = wi + wo;
    const float length2 = dot(sum, sum);
    if (length2 > 0.0f) {
        const vec3 h = sum / sqrt(length2);
        const vec3 fresnel = specular_fresnel(bsdf, dot(wi, h));
        const Facets facets = facets_at(wo, wi, h, bsdf.alpha);
        result.value = fresnel * facets.value;
        result.pdf = bsdf.chances.y * facets.pdf;
    }
    float passes = InversePi;
    if (bsdf.base_f90 > 0.0f || bsdf.f90 > 0.0f) {
        const vec2 energy = lobe_energy(table, wi.z, bsdf.roughness);
        passes = bsdf.base_out * passes_interface(bsdf, energy);
        result.value += bsdf.late * (bsdf.late_out * (1.0f - energy.x - energy.y) * wi.z);
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

inline void add_glass(INOUT(BsdfValue) result, IN(Bsdf) bsdf, vec3 wo, vec3 wi) {
    const GlassValue glass = evaluate_rough_glass(bsdf.glass, wo, wi);
    result.value += glass.value * bsdf.glass_share;
    result.pdf += glass_chance(bsdf) * glass.pdf;
}

// Where fibres seen along the surface would reflect more than comes in, they reflect all of it; by the lesser
// of both directions' limits, so that it stays reciprocal.
inline float capped_sheen(FloatArray table, IN(Bsdf) bsdf, vec3 wo, vec3 wi) {
    const float most = greater_of(sheen_energy(table, wo.z, bsdf.sheen_roughness),
                                  sheen_energy(table, wi.z, bsdf.sheen_roughness));
    return sheen_value(wo, wi, bsdf.sheen_alpha) / greater_of(most, 1.0f);
}

inline BsdfValue evaluate_bsdf(FloatArray table, IN(Bsdf) bsdf, vec3 wo, vec3 wi) {
    BsdfValue result = BsdfValue(vec3(0.0f), 0.0f, vec3(0.0f));
    if ((bsdf.lobes & FeatureShader) != 0u) {
        return wo.z > 0.0f && wi.z > 0.0f ? evaluate_shader(bsdf.shader, wo, wi) : result;
    }
    if ((bsdf.lobes & FeatureMedia) != 0u) {
        const float value = phase_value(bsdf.anisotropy, wi);
        return BsdfValue(vec3(value), value, vec3(0.0f));
    }
    const bool glass = (bsdf.lobes & FeatureRoughGlass) != 0u;
    if (!(wo.z > 0.0f) || wi.z == 0.0f || (wi.z < 0.0f && !glass)) return result;
    if (wi.z > 0.0f) evaluate_base(result, table, bsdf, wo, wi);
    if (glass) add_glass(result, bsdf, wo, wi);
    if ((bsdf.lobes & (FeatureCoat | FeatureSheen)) == 0u) return result;
    const float passes = passes_layers(table, bsdf, wi);
    result.value *= passes;
    result.diffuse *= passes;
    if (!(wi.z > 0.0f)) return result;
    if (has_rough_coat(bsdf)) {
        BsdfValue coat = BsdfValue(vec3(0.0f), 0.0f, vec3(0.0f));
        add_coat(coat, bsdf, wo, wi);
        float under_sheen = 1.0f;
        if ((bsdf.lobes & FeatureSheen) != 0u) {
            under_sheen = lesser_of(passes_sheen(table, bsdf, wi.z), bsdf.sheen_out);
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
    if ((bsdf.lobes & FeatureShader) != 0u) return sample_shader(bsdf.shader, wo, choice, u);
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
    return sample_rough_glass(bsdf.glass, wo, rest, u);
}

SHADING_END

#endif
