// Light of surfaces under a coat or sheen: both are layers over the emission, whichever way the light is found.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

scene::Material coated_lamp(float roughness) {
    scene::Material material = lamp(1.0f);
    material.clearcoat = 1.0f;
    material.clearcoat_roughness = roughness;
    return material;
}

// The light of a coated lamp that is seen at this angle, in a dark room.
double seen_at(const scene::Material& material, double angle) {
    Model model;
    model.floor(model.material(material), 50.0f, 0.0f);
    const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), angle, {1.0, 0.0, 0.0});
    view::View view = small_view(glm::dvec3(turn * glm::dvec4(0.0, 0.0, 2.0, 1.0)), 1e-3, 4, turn);
    view.max_bounces = 0;
    return mean_of(model.build(), view, 1, red).value;
}

// KHR_materials_clearcoat: emission x (1 - clearcoat x Fresnel), of index 1.5.
TEST(CoatedEmission, IsDimmedByFresnel) {
    for (const double angle : {0.0, 0.7, 1.2, 80.0 * M_PI / 180.0}) {
        const double expected = 1.0 - 0.04 - 0.96 * std::pow(1.0 - std::cos(angle), 5.0);
        EXPECT_NEAR(seen_at(coated_lamp(0.0f), angle), expected, 2e-3) << angle;
    }
}

TEST(SheenOverEmission, IsALayerAboveIt) {
    scene::Material material = lamp(1.0f);
    material.sheen_color = glm::vec3(0.5f);
    material.sheen_roughness = 0.5f;
    const double steep = seen_at(material, 0.0), grazing = seen_at(material, 1.3);
    EXPECT_LT(steep, 1.0);
    EXPECT_GT(steep, 0.5);
    EXPECT_LT(grazing, steep) << "sheen is strongest at grazing angles";
}

// Of a floor lit by a coated lamp, by each strategy.
TEST(CoatedEmission, IsTheSameForBothTechniques) {
    for (const float roughness : {0.0f, 0.4f}) {
        Model model;
        model.floor(model.material(chalk(glm::vec3(0.6f))), 100.0f, 0.0f);
        scene::Material material = coated_lamp(roughness);
        material.sheen_color = glm::vec3(0.3f);
        material.sheen_roughness = 0.6f;
        model.floor(model.material(material), -4.0f, 1.5f);
        const SceneAdapter& world = model.build();
        view::View view = small_view({0.0, 0.0, 0.5}, 1e-3);
        view.max_bounces = 0;
        Mean means[2];
        std::uint64_t rays = 0;
        for (const Strategy strategy : {Strategy::LightsOnly, Strategy::BsdfOnly}) {
            const PathTracer tracer(world.tables(), world.scene(), view, strategy);
            constexpr std::uint64_t Count = 256 * 512;
            double sum = 0, squares = 0;
            for (std::uint64_t i = 0; i < Count; ++i) {
                const double value = red(tracer.trace(i % 16, i / 16 % 16, i / 256, rays));
                sum += value;
                squares += value * value;
            }
            const double mean = sum / Count;
            means[strategy == Strategy::BsdfOnly] = {
                mean, std::sqrt(std::max(0.0, squares / Count - mean * mean) / Count)};
        }
        EXPECT_GT(means[0].value, 0.1);
        EXPECT_NEAR(means[0].value, means[1].value,
                    4.0 * std::hypot(means[0].standard_error, means[1].standard_error));
    }
}

}  // namespace
}  // namespace tessera::embree
