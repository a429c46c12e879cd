// Media against closed forms: Beer and Lambert, emission, single scattering in a slab, Chandrasekhar's half space,
// furnaces, nesting; over optical depths of 1e-6 to 1e6.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

using glm::vec3;
using scene::Medium;

constexpr ObjectId NoMaterial{};

double channel(const PathSample& sample, int index) {
    return double(radiance_of(sample)[index]);
}

Mean mean_of_channel(const World& world, const view::View& view, std::uint64_t spp, int c) {
    return mean_of(world, view, spp, [&](const PathSample& s) { return channel(s, c); });
}

// Straight down on whatever lies around the origin.
view::View from_above(double height = 10.0) {
    return small_view({0, 0, height}, 1e-4);
}

constexpr float Wide = 1e4f;

view::View whitted(view::View view) {
    view.renderer = view::Renderer::Whitted;
    return view;
}

void expect_value(const World& world, const view::View& view, const vec3& expected, double tolerance) {
    for (int c = 0; c < 3; ++c) {
        const Mean mean = mean_of_channel(world, view, 4, c);
        EXPECT_NEAR(mean.value, double(expected[c]), tolerance * double(expected[c]) + 1e-30) << c;
        EXPECT_LE(mean.standard_error, 1e-6 * double(expected[c]) + 1e-30);
    }
}

vec3 exp(const vec3& x) {
    return {std::exp(x.x), std::exp(x.y), std::exp(x.z)};
}

// ---- absorption and emission: no noise at all ----

TEST(Media, AbsorbAsBeerAndLambertSay) {
    for (const float thickness : {1e-6f, 1e-3f, 1.0f, 10.0f, 80.0f}) {
        const vec3 absorption = thickness * vec3(0.5f, 1.0f, 0.25f);
        Model model;
        model.filled_with({.absorption = absorption});
        model.box(NoMaterial, {-1, -1, 0}, {1, 1, 2});
        model.sky(vec3(3.0f));
        const World& world = model.build();
        EXPECT_TRUE(model.problems.empty());
        // A leg starts and ends within the error boxes of its points, 12 roundings of coordinates of up to 2 m
        // (points.h), and has the rounding of the way from the eye: 2e-6 of these two metres' exponent.
        const double tolerance = 1e-6 + 2e-6 * 2.0 * double(thickness);
        expect_value(world, from_above(), 3.0f * exp(-2.0f * absorption), tolerance);
        expect_value(world, whitted(from_above()), 3.0f * exp(-2.0f * absorption), tolerance);
        // From within, and beside it.
        expect_value(world, from_above(0.5), 3.0f * exp(-0.5f * absorption), tolerance);
        expect_value(world, small_view({5, 0, 10}, 1e-4), vec3(3.0f), 0.0);
    }
}

TEST(Media, EmitAlongTheWay) {
    for (const float depth : {1e-6f, 0.1f, 0.5f, 3.0f, 1e6f}) {
        const vec3 absorption = 0.5f * depth * vec3(1.0f, 0.5f, 0.0f);
        Model model;
        model.filled_with({.emission = vec3(0.4f), .absorption = absorption});
        model.box(NoMaterial, {-1, -1, 0}, {1, 1, 2});
        const World& world = model.build();
        vec3 expected;
        for (int c = 0; c < 3; ++c) {
            const double x = 2.0 * double(absorption[c]);
            expected[c] = static_cast<float>(x > 0.0 ? 0.4 * 2.0 * -std::expm1(-x) / x : 0.8);
        }
        expect_value(world, from_above(), expected, 2e-6);
        expect_value(world, whitted(from_above()), expected, 2e-6);
    }
}

// The colour that is left after a distance.
TEST(Media, GlassOfGltfDimsAsItsAttenuationSays) {
    Model model;
    scene::Material material = glass(1.0f);
    material.attenuation_color = {0.9f, 0.5f, 0.0f};
    material.attenuation_distance = 0.5f;
    const ObjectId body = model.material(material);
    model.box(body, {-1, -1, 0}, {1, 1, 2});
    model.sky(vec3(1.0f));
    const World& world = model.build();
    EXPECT_TRUE(model.problems.empty());
    expect_value(world, from_above(), {std::pow(0.9f, 4.0f), std::pow(0.5f, 4.0f), 0.0f}, 6e-6);
    expect_value(world, whitted(from_above()), {std::pow(0.9f, 4.0f), std::pow(0.5f, 4.0f), 0.0f}, 6e-6);
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

TEST(Media, ScatterOnceInASlabAsTheClosedFormSays) {
    for (const Slab slab :
         {Slab{0.3f, 0.7f, 0.0f, 1.0f}, Slab{0.0f, 2.0f, 0.6f, 0.7f}, Slab{1.0f, 0.2f, -0.5f, 2.0f},
          Slab{0.0f, 1e-6f, 0.3f, 1.0f}, Slab{0.0f, 1e6f, 0.0f, 1.0f}}) {
        Model model;
        model.filled_with({.absorption = vec3(slab.absorption),
                           .scattering = vec3(slab.scattering),
                           .anisotropy = slab.anisotropy});
        model.box(NoMaterial, {-Wide, -Wide, 0}, {Wide, Wide, slab.depth});
        // The sun is behind the eye; and a second slab is seen against a sun behind it.
        model.light({.kind = scene::LightKind::Directional, .intensity = vec3(1.0f)}, glm::dmat4(1.0));
        const World& world = model.build();
        const glm::dmat4 up = glm::rotate(glm::dmat4(1.0), M_PI, glm::dvec3(0, 1, 0));
        for (const bool above : {true, false}) {
            const double expected = seen_of(slab, above);
            if (expected < 1e-20) continue;
            view::View view = above ? from_above() : small_view({0, 0, -10}, 1e-4, 16, up);
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
TEST(Media, ScatterOftenAsChandrasekharsHalfSpaceDoes) {
    for (const float albedo : {0.5f, 0.9f, 0.99f}) {
        Model model;
        model.filled_with({.absorption = vec3(1.0f - albedo), .scattering = vec3(albedo)});
        model.box(NoMaterial, {-Wide, -Wide, -1000}, {Wide, Wide, 0});
        model.sky(vec3(1.0f));
        const World& world = model.build();
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

TEST(MediaFurnace, WhatOnlyScattersIsInvisible) {
    for (const float depth : {1e-6f, 0.1f, 3.0f, 100.0f}) {
        for (const float anisotropy : {-0.9f, 0.0f, 0.5f, 1.0f}) {
            Model model;
            model.filled_with({.scattering = depth * vec3(1.0f, 0.3f, 0.0f), .anisotropy = anisotropy});
            model.sphere(NoMaterial, {0, 0, 0}, 1.0);
            model.sky(vec3(1.0f));
            const World& world = model.build();
            for (int c = 0; c < 3; ++c) {
                const Mean mean = mean_of_channel(world, small_view({0, 0, 3}, 0.8), 64, c);
                EXPECT_NEAR(mean.value, 1.0, 4.5 * mean.standard_error + 1e-5)
                    << depth << " " << anisotropy << " " << c;
                EXPECT_LE(mean.standard_error, 0.02);
            }
        }
    }
}

// Optical depth 1e6 of a medium that absorbs next to nothing: paths have to come out again.
TEST(MediaFurnace, ADenseOneReflectsAllButWhatItAbsorbs) {
    Model model;
    model.filled_with({.scattering = vec3(1e6f)});
    model.box(NoMaterial, {-1, -1, 0}, {1, 1, 1});
    model.sky(vec3(1.0f));
    const Mean mean = mean_of(model.build(), from_above(), 64, red);
    // What is scattered more than 65536 times comes as few bright samples: a share of 0.0022.
    EXPECT_NEAR(mean.value, 1.0, 4.5 * mean.standard_error + 0.0022);
}

TEST(MediaFurnace, GlassFilledWithFogIsInvisible) {
    for (const float roughness : {0.0f, 0.3f}) {
        Model model;
        model.filled_with({.scattering = vec3(2.0f)});
        scene::Material material = glass(1.5f);
        material.roughness = roughness;
        model.sphere(model.material(material), {0, 0, 0}, 1.0, Normals::Smooth);
        model.sky(vec3(1.0f));
        const Mean mean = mean_of(model.build(), small_view({0, 0, 3}, 0.5), 64, red);
        // Rough glass keeps 0.99 of the light at each crossing.
        EXPECT_NEAR(mean.value, 1.0, 4.5 * mean.standard_error + (roughness > 0.0f ? 0.06 : 1e-4));
    }
}

// ---- light in fog: the ways to find it agree ----

void expect_agreement(Model& model) {
    constexpr std::uint64_t Spp = 512;
    view::View view = small_view({0, 0, 5}, 0.5);
    view.max_bounces = 3;
    const World& world = model.build();
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
    model.filled_with({.absorption = vec3(absorption), .scattering = vec3(scattering), .anisotropy = 0.4f});
    model.box(NoMaterial, {-2, -2, -2}, {2, 2, 2});
    model.filled_with_nothing();
}

TEST(Media, AGlowingTriangleInFogIsFoundBothWays) {
    Model model;
    add_fog(model);
    model.triangles(model.material(lamp(5.0f)), {{vec3(1, -1, 0), vec3(1, 1, 0), vec3(1, 0, 1.5f)}});
    model.floor(model.material(chalk(vec3(0.5f))), 1.5f, -1.0f);
    expect_agreement(model);
}

TEST(Media, AGlowingTriangleOutsideOfFogIsFoundBothWays) {
    Model model;
    add_fog(model);
    model.triangles(model.material(lamp(5.0f)), {{vec3(3, -2, 0), vec3(3, 2, 0), vec3(3, 0, 3)}});
    expect_agreement(model);
}

TEST(Media, ASphereLightInFogIsFoundBothWays) {
    Model model;
    add_fog(model);
    model.light({.kind = scene::LightKind::Sphere, .intensity = vec3(2.0f), .radius = 0.3f},
                glm::translate(glm::dmat4(1.0), glm::dvec3(0.5, 0, 0)));
    expect_agreement(model);
}

TEST(Media, ASunOnFogIsFoundBothWays) {
    Model model;
    add_fog(model);
    model.light({.kind = scene::LightKind::Directional, .intensity = vec3(1.0f), .angle = 0.8f},
                glm::rotate(glm::dmat4(1.0), 0.5, glm::dvec3(1, 0, 0)));
    model.sky(vec3(0.2f));
    expect_agreement(model);
}

// ---- bodies in bodies ----

// Layers of four metres each along z, of absorption 0.1 and 0.2 where they overlap by two.
double through(std::int32_t first, std::int32_t second) {
    Model model;
    model.filled_with({.absorption = vec3(0.1f), .priority = first});
    model.box(NoMaterial, {-1, -1, 0}, {1, 1, 4});
    model.filled_with({.absorption = vec3(0.2f), .priority = second});
    model.box(NoMaterial, {-0.5f, -0.5f, 2}, {0.5f, 0.5f, 6});
    model.sky(vec3(1.0f));
    return -std::log(mean_of(model.build(), from_above(), 1, red).value);
}

TEST(NestedMedia, ThePriorityFillsWhatOverlaps) {
    EXPECT_NEAR(through(1, 0), 4 * 0.1 + 2 * 0.2, 1e-5);
    EXPECT_NEAR(through(0, 1), 2 * 0.1 + 4 * 0.2, 1e-5);
    // Of equals, that which was entered last: from above, the lower one.
    EXPECT_NEAR(through(0, 0), 4 * 0.1 + 2 * 0.2, 1e-5);
}

TEST(NestedMedia, TheEyeMayBeInSeveral) {
    Model model;
    float size = 1.0f;
    double expected = 0.0;
    for (int i = 0; i < 6;
         ++i) {  // more than are kept: the innermost count most, and are the last to be lost
        model.filled_with({.absorption = vec3(0.1f * float(i + 1)), .priority = 6 - i});
        model.box(NoMaterial, vec3(-size), vec3(size));
        expected += 0.1 * (i + 1) * (i < 4 ? (i == 0 ? 1.0 : 0.5 * double(size)) : 0.0);
        size *= 2.0f;
    }
    model.sky(vec3(1.0f));
    const World& world = model.build();
    const double depth = -std::log(mean_of(world, from_above(0.0), 1, red).value);
    EXPECT_NEAR(depth, expected, 1e-5);
}

// Clear glass keeps out the fog around it; a box of glass of index 1 does not bend.
TEST(NestedMedia, ABodyOfGlassKeepsFogOut) {
    Model model;
    model.filled_with({.absorption = vec3(0.5f)});
    model.box(NoMaterial, {-2, -2, -2}, {2, 2, 2});
    model.filled_with_nothing();
    model.box(model.material(glass(1.0f)), vec3(-1), vec3(1));
    model.sky(vec3(1.0f));
    const World& world = model.build();
    EXPECT_NEAR(-std::log(mean_of(world, from_above(), 1, red).value), 0.5 * 2.0, 1e-5);
    EXPECT_NEAR(-std::log(mean_of(world, from_above(0.0), 1, red).value), 0.5 * 1.0, 1e-5);
}

TEST(NestedMedia, LayersHideTheirBodies) {
    Model model;
    model.filled_with({.absorption = vec3(0.5f)});
    model.box(NoMaterial, {-2, -2, -2}, {2, 2, 2});
    model.sky(vec3(1.0f));
    const World& world = model.build();
    view::View view = from_above(0.0);
    view.layers = 2;
    EXPECT_NEAR(mean_of(world, view, 1, red).value, 1.0, 1e-6);
}

// A fog that ends with the floor: where both are met at once, the floor is there.
TEST(Media, FogMayStandOnTheFloor) {
    for (const double angle : {0.0, 0.6, 1.2}) {
        for (const float height : {0.0f, 0.37f, -123.456f}) {
            Model model;
            model.filled_with({.absorption = vec3(0.5f)});
            model.box(NoMaterial, {-30, -30, height}, {30, 30, height + 1.0f});
            model.filled_with_nothing();
            model.floor(
                model.material(
                    {.base_color = {0, 0, 0, 1}, .emission = vec3(2.0f), .index_of_refraction = 1.0f}),
                100.0f, height);
            const World& world = model.build();
            const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), angle, glm::dvec3(1, 0, 0));
            const glm::dvec3 eye = glm::dvec3(turn * glm::dvec4(0, 0, 3, 1)) + glm::dvec3(0.01, 0.02, height);
            const Mean mean = mean_of(world, small_view(eye, 0.01, 16, turn), 16, red);
            const double expected = 2.0 * std::exp(-0.5 / std::cos(angle));
            EXPECT_NEAR(mean.value, expected, 0.03 * expected) << angle << " " << height;
            EXPECT_LE(mean.standard_error, 2e-3 * expected);
        }
    }
}

// And what the floor scatters goes through the fog again, as if that went on below.
TEST(Media, LightGoesOnInTheFogThatStandsOnTheFloor) {
    const auto seen = [](float bottom) {
        Model model;
        model.filled_with({.absorption = vec3(0.5f)});
        model.box(NoMaterial, {-30, -30, bottom}, {30, 30, 1.0f});
        model.filled_with_nothing();
        model.floor(model.material(chalk(vec3(0.8f))), 100.0f, 0.0f);
        model.sky(vec3(1.0f));
        return mean_of(model.build(), small_view({0.01, 0.02, 3}, 0.01), 64, red);
    };
    const Mean ends = seen(0.0f), goes_on = seen(-1.0f);
    EXPECT_NEAR(ends.value, goes_on.value, 4.5 * std::hypot(ends.standard_error, goes_on.standard_error));
    EXPECT_LE(goes_on.standard_error, 0.02 * goes_on.value);
    EXPECT_LE(goes_on.value, 0.8 * std::exp(-1.0));  // at least a metre of fog on both ways
}

// ---- holes in a boundary ----

// A black wall of which chance leaves half open, around a fog.
void add_holed_fog(Model& model, float absorption, float alpha, scene::AlphaMode mode) {
    model.filled_with({.absorption = vec3(absorption)});
    model.box(model.material({.base_color = {0, 0, 0, alpha},
                              .alpha_mode = mode,
                              .double_sided = true,
                              .index_of_refraction = 1.0f}),
              {-50, -50, 0}, {50, 50, 2});
    model.filled_with_nothing();
}

// Whoever comes in through a hole is inside.
TEST(HoledMedia, AreEnteredThroughTheirHoles) {
    for (const bool blends : {true, false}) {
        Model model;
        const float alpha = blends ? 0.5f : 0.0f;
        add_holed_fog(model, 0.4f, alpha, blends ? scene::AlphaMode::Blend : scene::AlphaMode::Mask);
        model.sky(vec3(3.0f));
        const World& world = model.build();
        EXPECT_TRUE(model.problems.empty());
        const double both_walls = double(1.0f - alpha) * double(1.0f - alpha);
        for (const view::View& view : {from_above(), whitted(from_above())}) {
            const Mean seen = mean_of(world, view, blends ? 4096 : 4, red);
            EXPECT_NEAR(seen.value, 3.0 * both_walls * std::exp(-0.8), 4.5 * seen.standard_error + 1e-5);
            EXPECT_LE(seen.standard_error, 0.003 * seen.value);
        }
        // From within, one wall is left.
        const Mean within = mean_of(world, from_above(1.0), blends ? 4096 : 4, red);
        EXPECT_NEAR(within.value, 3.0 * double(1.0f - alpha) * std::exp(-0.4),
                    4.5 * within.standard_error + 1e-5);
    }
}

// And so is light on its way to a floor below.
TEST(HoledMedia, DimLightThatComesThroughTheirHoles) {
    for (const scene::LightKind kind : {scene::LightKind::Directional, scene::LightKind::Point}) {
        Model model;
        add_holed_fog(model, 0.4f, 0.5f, scene::AlphaMode::Blend);
        model.floor(model.material(chalk(vec3(0.5f))), 10.0f, -2.0f);
        model.light({.kind = kind, .intensity = vec3(kind == scene::LightKind::Point ? 36.0f : 1.0f)},
                    glm::translate(glm::dmat4(1.0), glm::dvec3(0, 0, 4)));
        view::View view = from_above(-1.0);
        view.max_bounces = 0;
        const Mean seen = mean_of(model.build(), view, 4096, red);
        EXPECT_NEAR(seen.value, 0.5 / M_PI * 0.25 * std::exp(-0.8), 4.5 * seen.standard_error + 1e-6);
        EXPECT_LE(seen.standard_error, 0.003 * seen.value);
    }
}

// Seen against nothing, a fog covers as much as it takes away.
TEST(Media, CoverTransparentBackgrounds) {
    for (const float scattering : {0.0f, 0.5f}) {
        Model model;
        model.filled_with({.absorption = vec3(0.3f), .scattering = vec3(scattering)});
        model.box(NoMaterial, {-1, -1, 0}, {1, 1, 2});
        model.sky(vec3(1.0f));
        const World& world = model.build();
        view::View view = from_above();
        view.transparent_background = true;
        for (const view::View& looked : {view, whitted(view)}) {
            const Mean alpha =
                mean_of(world, looked, 256, [](const PathSample& s) { return double(s.alpha); });
            EXPECT_NEAR(alpha.value, -std::expm1(-2.0 * (0.3 + double(scattering))),
                        4.5 * alpha.standard_error + 1e-6);
        }
    }
}

// What is seen through an open body is that which is behind it.
TEST(Media, BoundariesWithoutASurfaceAreNoObjects) {
    Model model;
    model.filled_with({.absorption = vec3(0.1f)});
    model.box(NoMaterial, {-1, -1, 0}, {1, 1, 2});
    model.filled_with_nothing();
    model.floor(model.material(chalk(vec3(0.5f))), 3.0f, -1.0f);
    model.sky(vec3(1.0f));
    const World& world = model.build();
    for (const view::Renderer renderer :
         {view::Renderer::PathTracing, view::Renderer::Whitted, view::Renderer::Coverage}) {
        view::View view = from_above();
        view.renderer = renderer;
        for_samples(world, view, 1, [&](const PathSample& sample) {
            EXPECT_NEAR(double(sample.depth), 11.0, 1e-4);
            EXPECT_EQ(double(sample.alpha), 1.0);
        });
    }
}

}  // namespace
}  // namespace tessera::embree
