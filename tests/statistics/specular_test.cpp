// Perfect mirrors and smooth glass against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "mediator/shading/perfect_specular.h"
#include "tests/statistics/lobes.h"
#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

using shading::fresnel_dielectric;
using shading::Mixture;
using shading::Specular;

constexpr Mixture Glass{.dielectric = 0.0f, .glass = 1.0f};

Specular clear_glass(float eta, const glm::vec3& out) {
    return make_specular(Glass, test::clear_boundary(eta), out);
}

glm::vec3 at_angle(double angle) {
    return {float(std::sin(angle)), 0.0f, float(std::cos(angle))};
}

TEST(Fresnel, AtNormalIncidence) {
    for (const double n : {1.01, 1.33, 1.5, 2.4, 10.0}) {
        const double expected = std::pow((n - 1.0) / (n + 1.0), 2.0);
        EXPECT_NEAR(fresnel_dielectric(1.0f, float(n)), expected, 1e-6);
        EXPECT_NEAR(fresnel_dielectric(1.0f, float(1.0 / n)), expected, 1e-6);
    }
    EXPECT_EQ(fresnel_dielectric(0.3f, 1.0f), 0.0f) << "no boundary";
    EXPECT_EQ(fresnel_dielectric(0.3f, 0.0f), 1.0f) << "an index without bound";
}

// At Brewster's angle the parallel part is 0 and the other ((n^2 - 1) / (n^2 + 1))^2.
TEST(Fresnel, AtBrewstersAngle) {
    for (const double n : {1.33, 1.5, 2.4}) {
        const double cosine = std::cos(std::atan(n));
        const double across = std::pow((n * n - 1.0) / (n * n + 1.0), 2.0);
        EXPECT_NEAR(fresnel_dielectric(float(cosine), float(n)), 0.5 * across, 1e-6);
    }
}

TEST(Fresnel, TotalReflectionFromTheCriticalAngleOn) {
    for (const double n : {1.33, 1.5, 2.4}) {
        const double critical = std::asin(1.0 / n);
        EXPECT_LT(fresnel_dielectric(float(std::cos(critical - 0.01)), float(1.0 / n)), 0.9f);
        for (const double beyond : {0.001, 0.1, 0.3}) {
            const glm::vec3 out = at_angle(critical + beyond);
            EXPECT_EQ(fresnel_dielectric(out.z, float(1.0 / n)), 1.0f);
            const Specular specular = clear_glass(float(1.0 / n), out);
            EXPECT_EQ(specular.refraction, glm::vec3(0.0f));
            EXPECT_EQ(specular.reflection, glm::vec3(1.0f));
        }
    }
    EXPECT_NEAR(fresnel_dielectric(0.0f, 1.5f), 1.0f, 1e-6) << "grazing";
}

// Reflectance is the same along the reverse path.
TEST(Fresnel, IsReciprocalAndConservesEnergy) {
    for (const float n : {1.01f, 1.33f, 1.5f, 2.4f}) {
        for (double angle = 0.0; angle < 1.57; angle += 0.01) {
            const glm::vec3 out = at_angle(angle);
            const Specular specular = clear_glass(n, out);
            EXPECT_NEAR(specular.reflection.x + specular.refraction.x, 1.0f, 1e-6f);
            EXPECT_NEAR(glm::length(specular.refracted), 1.0f, 1e-6f);
            // The reverse direction takes a root of a small difference: near grazing its rounding counts the more.
            const float rounding = 4e-6f / out.z;
            EXPECT_NEAR(fresnel_dielectric(-specular.refracted.z, 1.0f / n), specular.reflection.x, rounding)
                << n << " " << angle;
        }
    }
}

TEST(Refraction, FollowsSnellsLaw) {
    for (const double n : {1.01, 1.33, 1.5, 2.4, 1 / 1.33, 1 / 2.4}) {
        for (double angle = 0.0; angle < 1.57; angle += 0.05) {
            if (std::sin(angle) / n >= 1.0) break;
            const Specular specular = clear_glass(float(n), at_angle(angle));
            EXPECT_NEAR(specular.refracted.x, -std::sin(angle) / n, 1e-6);
            EXPECT_LT(specular.refracted.z, 0.0f);
            EXPECT_EQ(specular.reflected, glm::vec3(-at_angle(angle).x, 0.0f, at_angle(angle).z));
        }
    }
}

// Through a slab of thickness t light comes down at (h - t) tan(i) + (2 k + 1) t tan(r) after k double
// reflections inside, which carry (1 - F)^2 F^(2 k): the mean follows. The floor's colour encodes the position.
TEST(Refraction, ASlabShiftsThePictureBehindIt) {
    for (const double n : {1.0, 1.33, 1.5, 2.4}) {
        Model model;
        const ObjectId slab = model.material(glass(float(n)));
        model.floor(slab, 50.0f, 1.0f);
        model.floor(slab, -50.0f, 0.5f);  // its back, seen from inside
        const ObjectId ruler = model.material({.base_color = {1, 1, 1, 1}, .unlit = true});
        model.floor(ruler, 10.0f, 0.0f, {{0, 1, 0, 1}, {1, 1, 0, 1}, {1, 1, 0, 1}, {0, 1, 0, 1}});
        SceneAdapter& world = model.build();
        constexpr double Angle = 0.7;
        const view::View view =
            small_view({0.0, 0.0, 3.0}, 1e-4, 8, glm::rotate(glm::dmat4(1.0), -Angle, {0.0, 1.0, 0.0}));
        double place = 0.0, seen = 0.0;
        for_samples(world, view, 64, [&](const PathSample& sample) {
            place += double(radiance_of(sample).x);
            seen += double(radiance_of(sample).y);
        });
        const double sine = std::sin(Angle), cosine = std::cos(Angle);
        const double f = double(fresnel_dielectric(float(cosine), float(n)));
        const double inside = std::tan(std::asin(sine / n)) * (1.0 + f * f) / (1.0 - f * f);
        EXPECT_NEAR(place / seen * 20.0 - 10.0, 2.5 * std::tan(Angle) + 0.5 * inside, 2e-3) << n;
        // What is not reflected: 2 crossings, with all orders of reflection inside.
        EXPECT_NEAR(seen / (64 * 64), (1.0 - f) / (1.0 + f), 0.02) << n;
    }
}

// In front of a sky of 1, clear glass is invisible.
class GlassFurnace : public testing::TestWithParam<std::tuple<float, Normals>> {};

TEST_P(GlassFurnace, AGlassSphereVanishes) {
    const auto& [index, normals] = GetParam();
    Model model;
    model.sphere(model.material(glass(index)), {0.0, 0.0, -3.0}, 1.0, normals);
    model.sky(glm::vec3(1.0f));
    SceneAdapter& world = model.build();
    std::uint64_t hits = 0, trapped = 0;
    const Mean mean = mean_of(world, small_view({}, 0.8, 32), 16, [&](const PathSample& sample) {
        hits += sample.object != 0 ? 1 : 0;
        trapped += std::fabs(red(sample) - 1.0) > 1e-4 ? 1 : 0;
        return red(sample);
    });
    EXPECT_GT(hits, 4000u) << "the sphere is there";
    EXPECT_NEAR(mean.value, 1.0, 4.0 * mean.standard_error + 1e-5);
    // A few paths run around inside until roulette ends them: with flat normals one in 10,000 (index 2.4).
    EXPECT_LE(trapped, hits / 1000);
}

INSTANTIATE_TEST_SUITE_P(Indices, GlassFurnace,
                         testing::Combine(testing::Values(1.0f, 1.01f, 1.33f, 1.5f, 2.4f),
                                          testing::Values(Normals::Flat, Normals::Smooth)));

TEST(Mirror, AWhiteBallVanishesToo) {
    for (const Normals normals : {Normals::Flat, Normals::Smooth}) {
        Model model;
        model.sphere(model.material(mirror(glm::vec3(1.0f))), {0.0, 0.0, -3.0}, 1.0, normals);
        model.sky(glm::vec3(1.0f));
        for_samples(model.build(), small_view({}, 0.8, 32), 16,
                    [&](const PathSample& sample) { ASSERT_NEAR(radiance_of(sample).x, 1.0f, 1e-4f); });
    }
}

TEST(Mirror, ShowsASkyInItsOwnColour) {
    Model model;
    const glm::vec3 color(0.9f, 0.5f, 0.1f);
    model.floor(model.material(mirror(color)), 10.0f, 0.0f);
    model.sky(glm::vec3(2.0f));
    SceneAdapter& world = model.build();
    for (const double angle : {0.0, 1.0, 1.5}) {
        const double distance = 1.0;
        const glm::dvec3 eye(-distance * std::sin(angle), 0.0, distance * std::cos(angle));
        const view::View view =
            small_view(eye, 1e-4, 4, glm::rotate(glm::dmat4(1.0), -angle, {0.0, 1.0, 0.0}));
        const double grazing = std::pow(1.0 - std::cos(angle), 5.0);
        for_samples(world, view, 4, [&](const PathSample& sample) {
            for (int i = 0; i < 3; ++i) {
                const double expected = double(color[i]) + (1.0 - double(color[i])) * grazing;
                EXPECT_NEAR(radiance_of(sample)[i], 2.0 * expected, 1e-3);
            }
            EXPECT_EQ(sample.high, glm::vec3(0.0f)) << "a sky in a mirror is no indirect light";
        });
    }
}

// Blends of two materials: the radiance is the weighted sum, whatever lobe a path samples.
double seen_light(const scene::Material& material, double& error) {
    Model model;
    model.floor(model.material(material), 10.0f, 0.0f);
    model.sky({1.0f, 0.0f, 0.0f});
    model.quad(model.material(lamp(5.0f)), {{{4, -2, 0.3f}, {4, 2, 0.3f}, {4, 2, 3}, {4, -2, 3}}});
    SceneAdapter& world = model.build();
    const view::View view =
        small_view({-1.0, 0.0, 0.6}, 0.2, 8, glm::rotate(glm::dmat4(1.0), -1.3, {0.0, 1.0, 0.0}));
    const Mean mean = mean_of(world, view, 512, red);
    error = std::hypot(error, mean.standard_error);
    return mean.value;
}

TEST(Mixtures, AreTheWeightedSumOfTheirParts) {
    const glm::vec4 color(0.8f, 0.6f, 0.3f, 1.0f);
    const auto metal_glass = [&](float metallic, float transmission) {
        return scene::Material{.base_color = color,
                               .metallic = metallic,
                               .roughness = 0.01f,
                               .double_sided = true,
                               .transmission = transmission,
                               .thickness = 1.0f};
    };
    double error = 0.0;
    const double opaque = seen_light(metal_glass(0, 0), error), clear = seen_light(metal_glass(0, 1), error),
                 metal = seen_light(metal_glass(1, 0), error);
    const double half_clear = seen_light(metal_glass(0, 0.5f), error);
    const double half_metal = seen_light(metal_glass(0.5f, 0), error);
    const double all = seen_light(metal_glass(0.5f, 0.5f), error);
    std::printf("opaque %.4f clear %.4f metal %.4f, error %.4f\n", opaque, clear, metal, error);
    EXPECT_LT(error, 0.02);
    EXPECT_NEAR(half_clear, 0.5 * (opaque + clear), 4.0 * error);
    EXPECT_NEAR(half_metal, 0.5 * (opaque + metal), 4.0 * error);
    EXPECT_NEAR(all, 0.5 * metal + 0.25 * (opaque + clear), 4.0 * error);
    EXPECT_GT(std::fabs(clear - opaque), 8.0 * error) << "the materials differ significantly";
}

// A floor before a white mirror sees the sky in all directions, half of it mirrored: light that comes from a
// scattering via a mirror counts in full.
TEST(Mirror, PassesOnAllLightToADiffuseFloor) {
    Model model;
    model.floor(model.material(chalk(glm::vec3(0.6f))), 100.0f, 0.0f);
    model.quad(model.material(mirror(glm::vec3(1.0f))),
               {{{0.5f, 200, 0}, {0.5f, -200, 0}, {0.5f, -200, 400}, {0.5f, 200, 400}}});
    model.sky(glm::vec3(1.0f));
    const Mean mean = mean_of(model.build(), small_view({0.0, 0.0, 1.0}, 0.3), 512, red);
    EXPECT_LT(mean.standard_error, 0.002);
    EXPECT_NEAR(mean.value, 0.6, 4.0 * mean.standard_error);
}

// A path that cannot leave a closed lossless mirror terminates nevertheless, without light.
TEST(Mirror, PathsInAClosedMirrorTerminate) {
    Model model;
    model.sphere(model.material(mirror(glm::vec3(1.0f))), {}, 1.0);
    model.sky(glm::vec3(1.0f));
    SceneAdapter& world = model.build();
    for_samples(world, small_view({}, 1.0, 4), 1,
                [&](const PathSample& sample) { EXPECT_EQ(radiance_of(sample), glm::vec3(0.0f)); });
}

}  // namespace
}  // namespace tessera::embree
