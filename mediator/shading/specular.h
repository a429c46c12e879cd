#pragma once

#include "mediator/shading/bsdf.h"

// Perfect mirrors and smooth glass: light goes on in one direction or two, without a density. Directions are
// in the shading frame (z = normal) and point away from the surface.
//   mirror  Schlick's Fresnel with F0 = base colour
//   glass   Fresnel's equations; what is refracted is tinted by the base colour, at every crossing
// Light is carried as basic radiance L / n^2 (Nicodemus 1963), which refraction does not change: the factors
// 1/eta^2 and eta^2 of entering and leaving a closed body cancel. Only what shines inside of glass is given
// as it would be in air.
namespace tessera::shading {

// Share of unpolarised light that the smooth boundary of two dielectrics reflects. `cosine` is that of the
// direction and the normal, in [0, 1]; eta = index of refraction on the far side / on this side; eta = 0
// stands for an index without bound.
inline float fresnel_dielectric(float cosine, float eta) {
    if (eta == 1.0f) return 0.0f;
    if (!(eta > 0.0f)) return 1.0f;
    const float sin2 = (1.0f - cosine) * (1.0f + cosine) / (eta * eta);
    if (!(sin2 < 1.0f)) return 1.0f;
    const float inside = std::sqrt(1.0f - sin2);
    const float parallel = (eta * cosine - inside) / (eta * cosine + inside);
    const float across = (cosine - eta * inside) / (cosine + eta * inside);
    return 0.5f * (parallel * parallel + across * across);
}

struct Specular {
    glm::vec3 reflection{0.0f}, refraction{0.0f};  // shares of the light that goes this way
    glm::vec3 reflected{0.0f}, refracted{0.0f};    // directions, of unit length where the share is not 0
    bool any() const { return largest(reflection) > 0.0f || largest(refraction) > 0.0f; }
};

// For mixtures without mirror and glass both shares are 0. At total reflection nothing is refracted.
inline Specular make_specular(const glm::vec3& base_color, const Mixture& mixture, float eta,
                              const glm::vec3& out) {
    Specular specular;
    const float fresnel = fresnel_dielectric(out.z, eta);
    specular.reflected = glm::vec3(-out.x, -out.y, out.z);
    specular.reflection = mixture.mirror * (base_color + (1.0f - base_color) * schlick_weight(out.z)) +
                          glm::vec3(mixture.glass * fresnel);
    specular.refraction = base_color * (mixture.glass * (1.0f - fresnel));
    if (!(fresnel < 1.0f)) return specular;
    // 1 - cos^2 from x and y: it does not cancel near the normal.
    const float sin2 = (out.x * out.x + out.y * out.y) / (eta * eta);
    const float inside = std::sqrt(greater_of(0.0f, 1.0f - sin2));
    specular.refracted = normalize(glm::vec3(-out.x / eta, -out.y / eta, -inside));
    return specular;
}

}  // namespace tessera::shading
