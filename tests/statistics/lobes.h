#pragma once

#include "mediator/backend/tables/tables.h"
#include "mediator/shading/bsdf.h"

// What tests of lobes start from.
namespace tessera::test {

inline shading::FloatArray energy_table() {
    return {backend::energy_values().data()};
}

inline shading::Bsdf make_bsdf(const shading::MaterialSample& material_sample,
                               const shading::Mixture& mixture, const glm::vec3& out) {
    shading::Bsdf bsdf;
    shading::fill_bsdf(bsdf, energy_table(), material_sample, mixture, out);
    return bsdf;
}

// Of untinted glass.
inline shading::RoughGlass clear_boundary(float eta) {
    const float f0 = shading::normal_reflectance(eta);
    return {.tint = glm::vec3(1.0f),
            .eta = eta,
            .f0 = glm::vec3(f0),
            .f90 = f0 > 0.0f ? 1.0f : 0.0f,
            .alpha = {},
            .thin = 0,
            .film = shading::no_film()};
}

}  // namespace tessera::test
