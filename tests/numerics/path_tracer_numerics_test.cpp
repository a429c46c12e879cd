// The path tracer at the limits of float precision: huge and tiny scenes, far from the origin, mirrors, grazing light,
// degenerate triangles.
#include <gtest/gtest.h>

#include <cmath>

#include "backends/embree/path_tracer.h"
#include "mediator/shading/bsdf.h"
#include "mediator/shading/surfaces.h"
#include "tests/statistics/furnace.h"
#include "tests/statistics/lobes.h"
#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

struct Place {
    double scale;
    glm::dvec3 center;
};

class FurnaceAnywhere : public testing::TestWithParam<Place> {};
class GlassAnywhere : public testing::TestWithParam<Place> {};

// The furnace is as bright at any size and place: leaking or self-shadowing walls would be visible.
TEST_P(FurnaceAnywhere, IsIndependentOfSizeAndPosition) {
    const auto& [scale, center] = GetParam();
    const Furnace furnace(0.5f, scale, center);
    view::View view;
    view.width = view.height = 32;
    view.max_bounces = view.max_specular_bounces = view::UnlimitedBounces;
    view.camera = view::perspective(glm::translate(glm::dmat4(1.0), center), 1.0, 1.0);
    const PathTracer tracer(furnace.world.tables(), furnace.world.scene(), view);
    double sum = 0, squares = 0, count = 0;
    std::uint64_t rays = 0;
    for (std::uint64_t sample = 0; sample < 64; ++sample) {
        for (std::uint32_t y = 0; y < 32; ++y) {
            for (std::uint32_t x = 0; x < 32; ++x) {
                const PathSample found = tracer.trace(x, y, sample, rays);
                const double value = radiance_of(found).x;
                ASSERT_TRUE(std::isfinite(value));
                ASSERT_TRUE(std::isfinite(found.depth)) << "the camera looked through the wall";
                sum += value;
                squares += value * value;
                ++count;
            }
        }
    }
    const double mean = sum / count, error = std::sqrt((squares / count - mean * mean) / count);
    EXPECT_LE(error, 0.003 * 2.0);
    EXPECT_NEAR(mean, 2.0, 4.0 * error);
}

INSTANTIATE_TEST_SUITE_P(Places, FurnaceAnywhere,
                         testing::Values(Place{1.0, {}}, Place{1e-4, {}}, Place{1e6, {}},
                                         Place{1.0, {1e6, -3e6, 2e6}}, Place{1.0, {200.3, 100.7, -250.1}},
                                         Place{0.01, {100.0, 50.0, 75.0}}));

// Finite, not negative and with a density wherever something comes back: for every roughness down to a
// mirror, and for light along the surface.
TEST(SurfaceModelNumerics, IsFiniteAtExtremes) {
    using namespace shading;
    for (const float roughness : {0.0f, 1e-6f, 1e-3f, 0.01f, 1.0f}) {
        for (const float cosine : {1.0f, 0.5f, 1e-3f, 1e-7f, 1e-20f}) {
            const glm::vec3 out(std::sqrt(1.0f - cosine * cosine), 0.0f, cosine);
            const MaterialSample material_sample =
                default_material_sample(glm::vec3(0.9f), 1.0f, roughness, 0.0f, 1.5f, 1.5f);
            const Bsdf bsdf = test::make_bsdf(material_sample, {1.0f, 0.0f}, out);
            for (std::uint32_t i = 0; i < 2000; ++i) {
                const Sampler sampler{i, 1};
                const glm::vec3 in =
                    sample_bsdf(bsdf, out, sample_pair(sampler, 0).x, sample_pair(sampler, 1));
                const BsdfValue value = evaluate_bsdf(test::energy_table(), bsdf, out, in);
                ASSERT_TRUE(std::isfinite(in.x) && std::isfinite(in.y) && std::isfinite(in.z));
                ASSERT_TRUE(std::isfinite(value.pdf) && value.pdf >= 0.0f) << roughness << " " << cosine;
                ASSERT_TRUE(std::isfinite(value.value.x) && value.value.x >= 0.0f)
                    << roughness << " " << cosine;
                if (value.value.x > 0.0f) {
                    ASSERT_GT(value.pdf, 0.0f);
                }
            }
        }
    }
}

// A ball of tinted glass with the index of air: whatever its size and place, light that passes it crosses two
// surfaces, so every sample is 1 or the tint squared, and deep inside of the silhouette the latter.
TEST_P(GlassAnywhere, ASphereIsCrossedTwice) {
    const auto& [scale, center] = GetParam();
    Model model(glm::round(center / 256.0) * 256.0);
    model.sphere(model.material(glass(1.0f, glm::vec3(0.5f))), center + glm::dvec3(0.0, 0.0, -3.0 * scale),
                 scale);
    model.sky(glm::vec3(1.0f));
    SceneAdapter& world = model.build();
    std::uint64_t hits = 0, wrong = 0;
    for_samples(world, small_view(center, 0.8, 32), 64, [&](const PathSample& sample) {
        const bool hit = sample.object != 0;
        const float expected = hit ? 0.25f : 1.0f;
        hits += hit ? 1 : 0;
        wrong += std::fabs(radiance_of(sample).x - expected) > 1e-5f ? 1 : 0;
    });
    EXPECT_GT(hits, 20000u);
    // None was seen; at the rim a ray may pass within its error box.
    EXPECT_LE(wrong, hits / 10000);
}

// With refraction: nothing leaks and nothing is lost.
TEST_P(GlassAnywhere, AClearSphereIsInvisible) {
    const auto& [scale, center] = GetParam();
    Model model(glm::round(center / 256.0) * 256.0);
    model.sphere(model.material(glass(1.5f)), center + glm::dvec3(0.0, 0.0, -3.0 * scale), scale);
    model.sky(glm::vec3(1.0f));
    SceneAdapter& world = model.build();
    for_samples(world, small_view(center, 0.8, 32), 8,
                [&](const PathSample& sample) { ASSERT_NEAR(radiance_of(sample).x, 1.0f, 1e-4f); });
}

INSTANTIATE_TEST_SUITE_P(Places, GlassAnywhere,
                         testing::Values(Place{1.0, {}}, Place{1e-4, {}}, Place{1e6, {}},
                                         Place{1.0, {1e6, -3e6, 2e6}}, Place{1.0, {200.3, 100.7, -250.1}},
                                         Place{0.01, {100.0, 50.0, 75.0}}));

// Fresnel fractions and directions of glass at any angle and index: finite, of unit length, summing to 1.
TEST(GlassNumerics, IsFiniteAtExtremes) {
    using namespace shading;
    constexpr Mixture Glass{.dielectric = 0.0f, .glass = 1.0f};
    for (const float eta : {0.01f, 0.4f, 0.9999999f, 1.0f, 1.0000001f, 1.01f, 1.5f, 2.4f, 100.0f}) {
        for (const float cosine : {1.0f, 0.9999999f, 0.5f, 1e-3f, 1e-7f, 1e-20f, 0.0f}) {
            const glm::vec3 out(std::sqrt(1.0f - cosine * cosine), 0.0f, cosine);
            const Specular specular = make_specular(Glass, test::clear_boundary(eta), out);
            ASSERT_TRUE(specular.reflection.x >= 0.0f && specular.reflection.x <= 1.0f + 1e-6f)
                << eta << " " << cosine;
            ASSERT_NEAR(specular.reflection.x + specular.refraction.x, 1.0f, 1e-6f);
            if (specular.refraction.x > 0.0f) {
                ASSERT_NEAR(glm::length(specular.refracted), 1.0f, 1e-6f) << eta << " " << cosine;
                ASSERT_LE(specular.refracted.z, 0.0f);
            }
        }
    }
}

TEST(HeuristicNumerics, HoldsForDensitiesOfAnySize) {
    using shading::power_heuristic;
    EXPECT_EQ(power_heuristic(0.0f, 1.0f), 0.0f);
    EXPECT_EQ(power_heuristic(1e30f, 1e30f), 0.5f);
    EXPECT_EQ(power_heuristic(1e38f, 1e-38f), 1.0f);
    EXPECT_EQ(power_heuristic(1e-38f, 1e38f), 0.0f);
    EXPECT_EQ(power_heuristic(1.0f, INFINITY), 0.0f);
}

}  // namespace
}  // namespace tessera::embree
