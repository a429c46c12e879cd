// Media against closed forms: Beer and Lambert, emission, single scattering in a slab, Chandrasekhar's half space,
// furnaces; over optical depths of 1e-6 to 1e6.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/statistics/media_views.h"

namespace tessera::embree {
namespace {

using glm::vec3;
using scene::Medium;

constexpr float Wide = 1e4f;

void expect_value(const SceneAdapter& world, const view::View& view, const vec3& expected, double tolerance) {
    for (int c = 0; c < 3; ++c) {
        const Mean mean = mean_of_channel(world, view, 4, c);
        EXPECT_NEAR(mean.value, double(expected[c]), tolerance * double(expected[c]) + 1e-30) << c;
        EXPECT_LE(mean.standard_error, 1e-6 * double(expected[c]) + 1e-30);
    }
}

vec3 exp(const vec3& x) {
    return {std::exp(x.x), std::exp(x.y), std::exp(x.z)};
}

// ---- absorption and emission: without noise ----

TEST(Media, AbsorptionFollowsBeerLambert) {
    for (const float thickness : {1e-6f, 1e-3f, 1.0f, 10.0f, 80.0f}) {
        const vec3 absorption = thickness * vec3(0.5f, 1.0f, 0.25f);
        Model model;
        model.set_medium({.absorption = absorption});
        model.box(NoMaterial, {-1, -1, 0}, {1, 1, 2});
        model.sky(vec3(3.0f));
        const SceneAdapter& world = model.build();
        EXPECT_TRUE(model.problems.empty());
        // A segment starts and ends within the error boxes of its points, 12 roundings of coordinates of up to 2 m
        // (triangle_points.h), and has the rounding of the distance from the eye: 2e-6 of these two metres' exponent.
        const double tolerance = 1e-6 + 2e-6 * 2.0 * double(thickness);
        expect_value(world, view_from_above(), 3.0f * exp(-2.0f * absorption), tolerance);
        expect_value(world, whitted(view_from_above()), 3.0f * exp(-2.0f * absorption), tolerance);
        // From inside, and next to it.
        expect_value(world, view_from_above(0.5), 3.0f * exp(-0.5f * absorption), tolerance);
        expect_value(world, small_view({5, 0, 10}, 1e-4), vec3(3.0f), 0.0);
    }
}

TEST(Media, EmissionIsIntegratedAlongTheRay) {
    for (const float depth : {1e-6f, 0.1f, 0.5f, 3.0f, 1e6f}) {
        const vec3 absorption = 0.5f * depth * vec3(1.0f, 0.5f, 0.0f);
        Model model;
        model.set_medium({.emission = vec3(0.4f), .absorption = absorption});
        model.box(NoMaterial, {-1, -1, 0}, {1, 1, 2});
        const SceneAdapter& world = model.build();
        vec3 expected;
        for (int c = 0; c < 3; ++c) {
            const double x = 2.0 * double(absorption[c]);
            expected[c] = static_cast<float>(x > 0.0 ? 0.4 * 2.0 * -std::expm1(-x) / x : 0.8);
        }
        expect_value(world, view_from_above(), expected, 2e-6);
        expect_value(world, whitted(view_from_above()), expected, 2e-6);
    }
}

// attenuation_color is the transmittance at attenuation_distance.
TEST(Media, GltfAttenuationColorIsReachedAtItsDistance) {
    Model model;
    scene::Material material = glass(1.0f);
    material.attenuation_color = {0.9f, 0.5f, 0.0f};
    material.attenuation_distance = 0.5f;
    const ObjectId solid = model.material(material);
    model.box(solid, {-1, -1, 0}, {1, 1, 2});
    model.sky(vec3(1.0f));
    const SceneAdapter& world = model.build();
    EXPECT_TRUE(model.problems.empty());
    expect_value(world, view_from_above(), {std::pow(0.9f, 4.0f), std::pow(0.5f, 4.0f), 0.0f}, 6e-6);
    expect_value(world, whitted(view_from_above()), {std::pow(0.9f, 4.0f), std::pow(0.5f, 4.0f), 0.0f}, 6e-6);
}

// ---- scattering ----

// A slab under light that comes straight down, and is seen from above or from below.
struct Slab {
    float absorption, scattering, anisotropy, depth;
};

double henyey_greenstein(double g, double cosine) {
    return (1 - g * g) / (4 * M_PI * std::pow(1 + g * g - 2 * g * cosine, 1.5));
}

double seen_of(const Slab& slab, bool from_above) {
    const double t = double(slab.absorption) + double(slab.scattering), s = slab.scattering, d = slab.depth;
    if (from_above) {
        return s * henyey_greenstein(slab.anisotropy, -1.0) * -std::expm1(-2 * t * d) / (2 * t);
    }
    return s * henyey_greenstein(slab.anisotropy, 1.0) * d * std::exp(-t * d);
}

TEST(Media, SingleScatteringInASlabMatchesTheClosedForm) {
    for (const Slab slab :
         {Slab{0.3f, 0.7f, 0.0f, 1.0f}, Slab{0.0f, 2.0f, 0.6f, 0.7f}, Slab{1.0f, 0.2f, -0.5f, 2.0f},
          Slab{0.0f, 1e-6f, 0.3f, 1.0f}, Slab{0.0f, 1e6f, 0.0f, 1.0f}}) {
        Model model;
        model.set_medium({.absorption = vec3(slab.absorption),
                          .scattering = vec3(slab.scattering),
                          .anisotropy = slab.anisotropy});
        model.box(NoMaterial, {-Wide, -Wide, 0}, {Wide, Wide, slab.depth});
        // The sun is behind the eye, and then behind the slab.
        model.light({.kind = scene::LightKind::Directional, .intensity = vec3(1.0f)}, glm::dmat4(1.0));
        const SceneAdapter& world = model.build();
        const glm::dmat4 up = glm::rotate(glm::dmat4(1.0), M_PI, glm::dvec3(0, 1, 0));
        for (const bool above : {true, false}) {
            const double expected = seen_of(slab, above);
            if (expected < 1e-20) continue;
            view::View view = above ? view_from_above() : small_view({0, 0, -10}, 1e-4, 16, up);
            view.max_bounces = 0;
            const Mean once = mean_of(world, whitted(view), 64, red);
            EXPECT_NEAR(once.value, expected, 4.5 * once.standard_error + 2e-5 * expected);
            EXPECT_LE(once.standard_error, 0.02 * expected);
            if (double(slab.scattering) < 1e-3) continue;  // one path in a million is scattered
            const Mean traced = mean_of(world, view, 1024, red);
            EXPECT_NEAR(traced.value, expected, 4.5 * traced.standard_error + 2e-5 * expected);
            EXPECT_LE(traced.standard_error, 0.02 * expected);
        }
    }
}

// H of isotropic scattering with albedo w (Chandrasekhar 1960, V.7), by iteration of
// 1 / H(m) = sqrt(1 - w) + w / 2 x integral of m' H(m') / (m + m').
double chandrasekhar_h(double albedo, double cosine) {
    constexpr int N = 400;
    std::vector<double> h(N, 1.0);
    const auto node = [&](int i) { return (i + 0.5) / N; };
    const auto next = [&](double mu) {
        double sum = 0.0;
        for (int i = 0; i < N; ++i) sum += node(i) * h[static_cast<std::size_t>(i)] / (mu + node(i)) / N;
        return 1.0 / (std::sqrt(1.0 - albedo) + 0.5 * albedo * sum);
    };
    for (int round = 0; round < 200; ++round) {
        std::vector<double> made(N);
        for (int i = 0; i < N; ++i) made[static_cast<std::size_t>(i)] = next(node(i));
        h = made;
    }
    return next(cosine);
}

// A half space under an even sky of 1 is seen as 1 - H(m) sqrt(1 - w).
TEST(Media, MultipleScatteringMatchesChandrasekharsHalfSpace) {
    for (const float albedo : {0.5f, 0.9f, 0.99f}) {
        Model model;
        model.set_medium({.absorption = vec3(1.0f - albedo), .scattering = vec3(albedo)});
        model.box(NoMaterial, {-Wide, -Wide, -1000}, {Wide, Wide, 0});
        model.sky(vec3(1.0f));
        const SceneAdapter& world = model.build();
        for (const double cosine : {1.0, 0.3}) {
            const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), std::acos(cosine), glm::dvec3(1, 0, 0));
            const glm::dvec3 eye = glm::dvec3(turn * glm::dvec4(0, 0, 5, 1));
            const Mean mean = mean_of(world, small_view(eye, 1e-4, 16, turn), 512, red);
            const double expected =
                1.0 - chandrasekhar_h(double(albedo), cosine) * std::sqrt(1.0 - double(albedo));
            EXPECT_NEAR(mean.value, expected, 4.5 * mean.standard_error + 2e-4) << albedo << " " << cosine;
            EXPECT_LE(mean.standard_error, 0.003 * expected + 0.001);
        }
    }
}

TEST(MediaFurnace, APurelyScatteringMediumIsInvisible) {
    for (const float depth : {1e-6f, 0.1f, 3.0f, 100.0f}) {
        for (const float anisotropy : {-0.9f, 0.0f, 0.5f, 1.0f}) {
            Model model;
            model.set_medium({.scattering = depth * vec3(1.0f, 0.3f, 0.0f), .anisotropy = anisotropy});
            model.sphere(NoMaterial, {0, 0, 0}, 1.0);
            model.sky(vec3(1.0f));
            const SceneAdapter& world = model.build();
            for (int c = 0; c < 3; ++c) {
                const Mean mean = mean_of_channel(world, small_view({0, 0, 3}, 0.8), 64, c);
                EXPECT_NEAR(mean.value, 1.0, 4.5 * mean.standard_error + 1e-5)
                    << depth << " " << anisotropy << " " << c;
                EXPECT_LE(mean.standard_error, 0.02);
            }
        }
    }
}

// Optical depth 1e6 of a medium without absorption: paths have to leave it again.
TEST(MediaFurnace, ADenseScatteringMediumReflectsEverything) {
    Model model;
    model.set_medium({.scattering = vec3(1e6f)});
    model.box(NoMaterial, {-1, -1, 0}, {1, 1, 1});
    model.sky(vec3(1.0f));
    const Mean mean = mean_of(model.build(), view_from_above(), 64, red);
    // Light scattered more than n = 65536 times arrives in few bright samples: a fraction of H / sqrt(pi n), since the albedo of a
    // half space is 1 - H sqrt(1 - w).
    const double late = chandrasekhar_h(1.0, 1.0) / std::sqrt(M_PI * 65536.0);
    EXPECT_NEAR(mean.value, 1.0, 4.5 * mean.standard_error + late);
}

TEST(MediaFurnace, GlassFilledWithFogIsInvisible) {
    for (const float roughness : {0.0f, 0.3f}) {
        Model model;
        model.set_medium({.scattering = vec3(2.0f)});
        scene::Material material = glass(1.5f);
        material.roughness = roughness;
        model.sphere(model.material(material), {0, 0, 0}, 1.0, Normals::Smooth);
        model.sky(vec3(1.0f));
        const Mean mean = mean_of(model.build(), small_view({0, 0, 3}, 0.5), 64, red);
        // Rough glass keeps 0.99 of the light at each crossing.
        EXPECT_NEAR(mean.value, 1.0, 4.5 * mean.standard_error + (roughness > 0.0f ? 0.06 : 1e-4));
    }
}

// ---- light in fog: all sampling strategies agree ----

void expect_agreement(Model& model) {
    constexpr std::uint64_t Spp = 512;
    view::View view = small_view({0, 0, 5}, 0.5);
    view.max_bounces = 3;
    const SceneAdapter& world = model.build();
    EXPECT_TRUE(model.problems.empty());
    std::vector<Mean> means;
    for (const Strategy strategy : {Strategy::Both, Strategy::LightsOnly, Strategy::BsdfOnly}) {
        const PathTracer tracer(world.tables(), world.scene(), view, strategy);
        double sum = 0, squares = 0;
        std::uint64_t rays = 0;
        const double n = 256.0 * double(Spp);
        for (std::uint64_t i = 0; i < 256 * Spp; ++i) {
            const double value = red(tracer.trace(i % 16, i / 16 % 16, i / 256, rays));
            sum += value;
            squares += value * value;
        }
        const double mean = sum / n;
        means.push_back({mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / n)});
    }
    EXPECT_LE(means[0].standard_error, 0.01 * means[0].value);
    for (int i = 1; i < 3; ++i) {
        const Mean& other = means[static_cast<std::size_t>(i)];
        EXPECT_NEAR(other.value, means[0].value,
                    4.5 * std::hypot(other.standard_error, means[0].standard_error) + 1e-6)
            << i;
    }
}

void add_fog(Model& model, float absorption = 0.1f, float scattering = 0.6f) {
    model.set_medium({.absorption = vec3(absorption), .scattering = vec3(scattering), .anisotropy = 0.4f});
    model.box(NoMaterial, {-2, -2, -2}, {2, 2, 2});
    model.clear_medium();
}

TEST(Media, StrategiesAgreeForAnEmissiveTriangleInFog) {
    Model model;
    add_fog(model);
    model.triangles(model.material(lamp(5.0f)), {{vec3(1, -1, 0), vec3(1, 1, 0), vec3(1, 0, 1.5f)}});
    model.floor(model.material(chalk(vec3(0.5f))), 1.5f, -1.0f);
    expect_agreement(model);
}

TEST(Media, StrategiesAgreeForAnEmissiveTriangleOutsideFog) {
    Model model;
    add_fog(model);
    model.triangles(model.material(lamp(5.0f)), {{vec3(3, -2, 0), vec3(3, 2, 0), vec3(3, 0, 3)}});
    expect_agreement(model);
}

TEST(Media, StrategiesAgreeForASphereLightInFog) {
    Model model;
    add_fog(model);
    model.light({.kind = scene::LightKind::Sphere, .intensity = vec3(2.0f), .radius = 0.3f},
                glm::translate(glm::dmat4(1.0), glm::dvec3(0.5, 0, 0)));
    expect_agreement(model);
}

TEST(Media, StrategiesAgreeForASunDiskAndFog) {
    Model model;
    add_fog(model);
    model.light({.kind = scene::LightKind::Directional, .intensity = vec3(1.0f), .angle = 0.8f},
                glm::rotate(glm::dmat4(1.0), 0.5, glm::dvec3(1, 0, 0)));
    model.sky(vec3(0.2f));
    expect_agreement(model);
}

}  // namespace
}  // namespace tessera::embree
