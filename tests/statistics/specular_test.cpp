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

// A frosted body is bounded twice, and light runs around in it: what one boundary loses counts many times.
TEST(RoughGlass, AFrostedSphereVanishesToo) {
    for (const float roughness : {0.3f, 0.6f, 1.0f}) {
        Model model;
        scene::Material frosted = glass(1.5f);
        frosted.roughness = roughness;
        model.sphere(model.material(frosted), {0.0, 0.0, -3.0}, 1.0, Normals::Flat);
        model.sky(glm::vec3(1.0f));
        // The sphere alone: it covers the picture.
        view::View view = small_view({}, 0.3, 256);
        const Mean mean = mean_of(model.build(), view, 64, red);
        EXPECT_LE(mean.value, 1.003 + 4.0 * mean.standard_error) << roughness;
        EXPECT_GE(mean.value, 0.99 - 4.0 * mean.standard_error) << roughness;
        EXPECT_LT(mean.standard_error, 2e-3) << roughness;
    }
}

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

// Nine balls of glass, one behind the other, in a white sky: 18 boundaries on the way of each path through all.
TEST(SpecularBounces, HaveALimitOfTheirOwn) {
    Model model;
    model.sky(glm::vec3(1.0f));
    const ObjectId clear = model.material(glass(1.5f));
    for (int i = 0; i < 9; ++i) model.sphere(clear, {0.0, 0.0, -2.5 * i}, 1.0, Normals::Smooth, 64);
    const SceneAdapter& world = model.build();
    view::View view = small_view({0.0, 0.0, 3.0}, 1e-3, 8);
    view.max_bounces = view::View().max_bounces;
    view.max_specular_bounces = view::View().max_specular_bounces;
    EXPECT_GT(mean_of(world, view, 64, red).value, 0.9) << "all but what is reflected to and fro";
    view.max_specular_bounces = 8;
    EXPECT_LT(mean_of(world, view, 64, red).value, 0.75) << "what is reflected before";
    view.max_specular_bounces = 0;
    EXPECT_EQ(mean_of(world, view, 4, red).value, 0.0);
}

// A limit of diffuse bounces does not end reflections, and those do not lengthen diffuse paths.
TEST(SpecularBounces, DoNotCountAsOthers) {
    Model model;
    model.floor(model.material(mirror(glm::vec3(1.0f))), 10.0f, 0.0f);
    model.floor(model.material(chalk(glm::vec3(0.5f))), -10.0f, 4.0f);
    model.point_light({0.0, 0.0, 2.0}, 10.0f);
    const SceneAdapter& world = model.build();
    // Down into the mirror, up to the ceiling, which the lamp lights.
    view::View view = small_view({0.3, 0.0, 1.0}, 1e-3, 8);
    view.max_bounces = 0;
    const Mean direct = mean_of(world, view, 16, red);
    const double distance2 = 4.0 + 0.09, cosine = 2.0 / std::sqrt(distance2);
    EXPECT_NEAR(direct.value, 0.5 / M_PI * 10.0 * cosine / distance2, 2e-3);
}

// ---- smooth plastic: a mirror over a diffuse base ----

scene::Material plastic(float roughness, float albedo) {
    return {.base_color = glm::vec4(glm::vec3(albedo), 1.0f), .metallic = 0.0f, .roughness = roughness};
}

// Black underneath: the sky, by Schlick's approximation, without noise.
TEST(SmoothPlastic, ReflectsAsAMirror) {
    for (const double angle : {0.0, 0.6, 1.2, 1.5}) {
        Model model;
        model.sky(glm::vec3(1.0f));
        model.floor(model.material(plastic(0.0f, 0.0f)), 100.0f, 0.0f);
        const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), angle, {1.0, 0.0, 0.0});
        const view::View view = small_view(glm::dvec3(turn * glm::dvec4(0.0, 0.0, 2.0, 1.0)), 1e-4, 4, turn);
        const double expected = 0.04 + 0.96 * std::pow(1.0 - std::cos(angle), 5.0);
        const Mean found = mean_of(model.build(), view, 4, red);
        EXPECT_NEAR(found.value, expected, 1e-3 * expected + 1e-5) << angle;
        EXPECT_LT(found.standard_error, 1e-3 * expected + 1e-6);
    }
}

// As bright as almost smooth plastic, and white in a white furnace.
TEST(SmoothPlastic, HasTheEnergyOfAlmostSmoothPlastic) {
    const auto brightness = [](float roughness, float albedo) {
        Model model;
        model.sky(glm::vec3(1.0f));
        model.sphere(model.material(plastic(roughness, albedo)), {}, 1.0, Normals::Smooth, 64);
        return mean_of(model.build(), small_view({0.0, 0.0, 3.0}, 0.3), 256, red).value;
    };
    EXPECT_NEAR(brightness(0.0f, 1.0f), 1.0, 0.003);
    EXPECT_NEAR(brightness(0.0f, 0.5f), brightness(0.02f, 0.5f), 0.003);
}

// A lobe of a hundredth of a degree that diffuse paths run into would make single samples of up to 1e5 times the mean.
TEST(SmoothPlastic, MakesNoFirefliesUnderAPointLight) {
    Model model;
    model.floor(model.material(chalk(glm::vec3(0.8f))), 3.0f, 0.0f);
    model.sphere(model.material(plastic(0.0f, 0.8f)), {0.0, 0.0, 0.5}, 0.5, Normals::Smooth, 64);
    model.point_light({1.0, 0.0, 2.0}, 10.0f);
    const SceneAdapter& world = model.build();
    const view::View view =
        small_view({0.0, -3.0, 2.0}, 0.9, 32, glm::rotate(glm::dmat4(1.0), 1.0, {1.0, 0.0, 0.0}));
    double most = 0.0, sum = 0.0, count = 0.0;
    for_samples(world, view, 256, [&](const PathSample& sample) {
        most = std::max(most, red(sample));
        sum += red(sample);
        ++count;
    });
    EXPECT_LT(most, 30.0 * sum / count);
}

}  // namespace
}  // namespace tessera::embree
