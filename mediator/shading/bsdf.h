#ifndef TESSERA_MEDIATOR_SHADING_BSDF_H
#define TESSERA_MEDIATOR_SHADING_BSDF_H

#include "mediator/shading/sampling.h"

// The surface model: glTF metallic-roughness as a diffuse lobe under a microfacet lobe. All directions are in
// the shading frame (z = normal) and point away from the surface.
//   specular  GGX, height-correlated Smith, Schlick's Fresnel with F0 = mix(((n-1)/(n+1))^2, base colour,
//   metallic) diffuse   (1 - metallic) base colour / pi (1 - F(cos i)) (1 - F(cos o)), F of the dielectric
//   part: light that the
//             coat reflects on its way in or out does not reach the base (as in Ashikhmin and Shirley 2000,
//             without their rescaling). Reciprocal; the sum never reflects more than comes in.
// Multiple scattering between facets is not modelled: rough metals are a little dark.
// Perfect mirrors and smooth glass have no density and are in specular.h; a material is a mixture of both
// kinds.
SHADING_BEGIN

// What a surface consists of: shares that sum to 1. This file knows metal (rough) and dielectric (opaque,
// coated).
struct Mixture {
    float metal, dielectric;
    float mirror, glass;
};

// Exactly 1 where there is neither mirror nor glass.
inline float rough_share(IN(Mixture) mixture) {
    return 1.0f - mixture.mirror - mixture.glass;
}

struct Bsdf {
    vec3 diffuse;   // albedo of the base
    vec3 f0;        // specular reflectance at normal incidence
    float coat_f0;  // of the dielectric part: what the diffuse lobe loses
    float f90,
        coat_f90;  // reflectance at grazing: all of its share, or 0 where there is no interface (index 1)
    float alpha;   // roughness^2
    float specular_share;  // probability of sampling the specular lobe
    float reflectance;     // estimate of all that is reflected, as luminance
};

// A mirror within float accuracy: below, D overflows. Its energy is unchanged, only the lobe's width is.
inline constexpr float MinAlpha = 1e-4f;

inline float schlick_weight(float cosine) {
    const float m = lesser_of(greater_of(1.0f - cosine, 0.0f), 1.0f);
    const float m2 = m * m;
    return m2 * m2 * m;
}

// 1 - schlick_weight, in a form that does not cancel at grazing angles.
inline float schlick_rest(float cosine) {
    const float c = lesser_of(greater_of(cosine, 0.0f), 1.0f);
    const float m = 1.0f - c;
    return c * (1.0f + m * (1.0f + m) * (1.0f + m * m));
}

inline Mixture make_mixture(float metallic, float roughness, float transmission) {
    const float opaque = 1.0f - metallic;
    Mixture mixture = Mixture(metallic, opaque, 0.0f, 0.0f);
    if (transmission > 0.0f) {
        mixture.glass = opaque * transmission;
        mixture.dielectric = opaque * (1.0f - transmission);
    }
    if (roughness * roughness <= MinAlpha) {
        mixture.mirror = metallic;
        mixture.metal = 0.0f;
    }
    return mixture;
}

inline Bsdf make_bsdf(vec3 base_color, IN(Mixture) mixture, float roughness, float index_of_refraction,
                      float cos_out) {
    Bsdf bsdf;
    const float r =
        index_of_refraction == 0.0f ? 1.0f : (index_of_refraction - 1.0f) / (index_of_refraction + 1.0f);
    bsdf.coat_f0 = r * r;
    bsdf.diffuse = base_color * mixture.dielectric;
    bsdf.f0 = vec3(bsdf.coat_f0) * mixture.dielectric + base_color * mixture.metal;
    bsdf.f90 = largest(bsdf.f0) > 0.0f ? rough_share(mixture) : 0.0f;
    bsdf.coat_f90 = bsdf.coat_f0 > 0.0f ? 1.0f : 0.0f;
    bsdf.alpha = greater_of(roughness * roughness, MinAlpha);
    const float fresnel = schlick_weight(cos_out);
    const float specular = luminance(bsdf.f0 + (bsdf.f90 - bsdf.f0) * fresnel);
    const float diffuse = luminance(bsdf.diffuse) * (1.0f - bsdf.coat_f0) * (1.0f - bsdf.coat_f90 * fresnel);
    const float sum = specular + diffuse;
    bsdf.reflectance = sum;
    // Never 0 or 1 while both lobes are there, so that no light is out of reach.
    bsdf.specular_share = sum > 0.0f ? lesser_of(greater_of(specular / sum, 0.1f), 0.9f) : 0.5f;
    if (!(largest(bsdf.diffuse) > 0.0f)) bsdf.specular_share = 1.0f;
    if (!(bsdf.f90 > 0.0f)) bsdf.specular_share = 0.0f;
    return bsdf;
}

// D of the half vector. In a form that does not cancel: 1 - cos^2 comes from x and y.
inline float ggx_distribution(vec3 h, float alpha) {
    const float a2 = alpha * alpha;
    const float slope = h.x * h.x + h.y * h.y + a2 * h.z * h.z;
    return a2 * InversePi / (slope * slope);
}

inline float smith_lambda(vec3 w, float alpha) {
    const float cos2 = w.z * w.z;
    if (!(cos2 > 0.0f)) return 1e20f;
    const float tan2 = (w.x * w.x + w.y * w.y) / cos2;
    return 0.5f * (sqrt(1.0f + alpha * alpha * tan2) - 1.0f);
}

// Half vectors in proportion to what is visible from `wo` (Heitz 2018).
inline vec3 sample_visible_normal(vec3 wo, float alpha, vec2 u) {
    const vec3 stretched = unit_vector(vec3(alpha * wo.x, alpha * wo.y, wo.z));
    const float length2 = stretched.x * stretched.x + stretched.y * stretched.y;
    const vec3 t1 =
        length2 > 0.0f ? vec3(-stretched.y, stretched.x, 0.0f) / sqrt(length2) : vec3(1.0f, 0.0f, 0.0f);
    const vec3 t2 = cross(stretched, t1);
    // The disk's point is pushed from the half that cannot be seen. In a form that does not cancel at the
    // rim: half_chord^2 = 1 - p.x^2, above = half_chord - p.y, below = half_chord + p.y, height^2 = above *
    // below.
    const vec2 p = sample_disk(u);
    const float s = 0.5f * (1.0f + stretched.z), rest = 0.25f * length2 / s;  // sum 1
    const float height = height_over_disk(u);
    const float half_chord = sqrt(height * height + p.y * p.y);
    const float longer = half_chord + abs(p.y);
    const float shorter = longer > 0.0f ? height * height / longer : 0.0f;
    const float above = p.y > 0.0f ? shorter : longer, below = p.y > 0.0f ? longer : shorter;
    const float y = half_chord - s * above;
    const float z = sqrt(s * above * (2.0f * rest * half_chord + s * below));
    const vec3 h = p.x * t1 + y * t2 + z * stretched;
    return unit_vector(vec3(alpha * h.x, alpha * h.y, greater_of(1e-12f, h.z)));
}

// Share of the light that the coat does not reflect on its way in or out. Without an interface coat_f0 is 0.
inline float passes_coat(IN(Bsdf) bsdf, float cosine) {
    return bsdf.coat_f90 > 0.0f ? (1.0f - bsdf.coat_f0) * schlick_rest(cosine) : 1.0f;
}

struct BsdfValue {
    vec3 value;    // f cos(wi)
    float pdf;     // per solid angle, of sample_bsdf
    vec3 diffuse;  // the diffuse lobe's part of the value
};

inline BsdfValue evaluate_bsdf(IN(Bsdf) bsdf, vec3 wo, vec3 wi) {
    BsdfValue result = BsdfValue(vec3(0.0f), 0.0f, vec3(0.0f));
    if (!(wi.z > 0.0f) || !(wo.z > 0.0f)) return result;
    const vec3 sum = wi + wo;
    const float length2 = dot(sum, sum);
    if (length2 > 0.0f) {
        const vec3 h = sum / sqrt(length2);
        const float distribution = ggx_distribution(h, bsdf.alpha);
        const float lambda_out = smith_lambda(wo, bsdf.alpha), lambda_in = smith_lambda(wi, bsdf.alpha);
        const vec3 fresnel = bsdf.f0 + (bsdf.f90 - bsdf.f0) * schlick_weight(dot(wi, h));
        result.value = fresnel * (distribution / (4.0f * wo.z * (1.0f + lambda_out + lambda_in)));
        result.pdf = bsdf.specular_share * distribution / (4.0f * wo.z * (1.0f + lambda_out));
    }
    const float keeps_in = passes_coat(bsdf, wi.z), keeps_out = passes_coat(bsdf, wo.z);
    result.diffuse = bsdf.diffuse * (keeps_in * keeps_out * wi.z * InversePi);
    result.value += result.diffuse;
    result.pdf += (1.0f - bsdf.specular_share) * wi.z * InversePi;
    return result;
}

// A direction; may point below the surface, where the value is 0.
inline vec3 sample_bsdf(IN(Bsdf) bsdf, vec3 wo, float choice, vec2 u) {
    if (choice >= bsdf.specular_share) return sample_cosine_hemisphere(u);
    const vec3 h = sample_visible_normal(wo, bsdf.alpha, u);
    return 2.0f * dot(wo, h) * h - wo;
}

SHADING_END

#endif
