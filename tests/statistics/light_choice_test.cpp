// The choice between the light tree, the sky and suns, and which part of the sky light samples look for.
#include <gtest/gtest.h>

#include <cmath>

#include "mediator/backend/tables/tables.h"
#include "mediator/shading/lights.h"
#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

using shading::Receiver;

constexpr float Up = 1.0f;

Receiver receiver(const glm::vec3& position, float up = Up) {
    return {position, {0.0f, 0.0f, up}, {}, shading::NoSkyCell};
}

// A room of 10 m that is open above, `scale` times as large: a lamp of 0.5 m at 3 m, a sun that stands high, a sky with a
// bright quarter.
struct House : Model {
    explicit House(double scale = 1.0, float ground = 10.0f) {
        scaled_by(scale);
        floor(material(chalk(glm::vec3(0.5f))), ground, 0.0f);
        floor(material(lamp(20.0f)), -0.25f, 3.0f);
        light({.kind = scene::LightKind::Directional, .intensity = glm::vec3(2.0f)}, glm::dmat4(1.0));
        const std::vector<glm::vec3> texels{glm::vec3(4.0f), glm::vec3(0.5f), glm::vec3(0.5f),
                                            glm::vec3(0.5f)};
        scene::Background background{.strength = 1.0f};
        background.environment =
            texture({.width = 2, .height = 2, .format = scene::TexelFormat::RgbFloat}, texels).texture;
        sky(background);
    }
};

// A view of these object layers.
shading::View seeing(std::uint32_t layers) {
    shading::View view{};
    view.layers = layers;
    view.sky_cells_from = shading::NoSkyCells;
    return view;
}

shading::LightChances chances_at(const shading::Scene& scene, const Receiver& place) {
    return light_chances(scene, seeing(shading::AllLayers), place);
}

TEST(LightChoice, FollowsTheIrradianceAtTheReceiver) {
    House house;
    const shading::Scene scene = backend::on_host(house.build().tables());
    const auto tree = [&](const Receiver& place) { return chances_at(scene, place).tree; };
    // Lamp: 20 x 0.25 m2 / d2; sun 2; sky pi x (what exceeds its mean).
    const float under = tree(receiver({0.0f, 0.0f, 1.0f})), away = tree(receiver({8.0f, 8.0f, 0.0f})),
                above = tree(receiver({0.0f, 0.0f, 20.0f}));
    const double excess = double(scene.lights.items[2].irradiance / scene.lights.items[1].irradiance) * 2.0;
    const double lamp_there = 20.0 * 0.25 / 4.0;
    EXPECT_NEAR(under, 0.8 * lamp_there / (lamp_there + 2.0 + excess) + 0.2 / 3.0, 0.08);
    EXPECT_LT(away, 0.5f * under);
    EXPECT_LT(above, 0.5f * under);
    EXPECT_GE(above, 0.2f / 3.0f) << "whatever the estimate";
}

TEST(LightChoice, IsTheSameAtAnyScaleAndOnAnyGround) {
    House plain;
    const shading::Scene scene = backend::on_host(plain.build().tables());
    const float expected = chances_at(scene, receiver({1.0f, 0.0f, 1.0f})).tree;
    for (const double scale : {1e-12, 1e-3, 1e4, 1e12}) {
        House other(scale);
        const shading::Scene scaled = backend::on_host(other.build().tables());
        // The light that arrives from a lamp does not change with the scale of all.
        const float found = chances_at(scaled, receiver(glm::vec3(1.0f, 0.0f, 1.0f) * float(scale))).tree;
        EXPECT_NEAR(found, expected, 1e-4f) << scale;
    }
    House wide(1.0, 1e5f);
    EXPECT_EQ(chances_at(backend::on_host(wide.build().tables()), receiver({1.0f, 0.0f, 1.0f})).tree,
              expected);
}

// Suns below the horizon have their even share only.
TEST(LightChoice, GivesSunsBelowTheHorizonTheirEvenShare) {
    House house;
    const shading::Scene scene = backend::on_host(house.build().tables());
    const shading::LightSource sun = scene.lights.items[1];
    ASSERT_EQ(sun.kind, shading::LightDirectional);
    const auto chance = [&](const Receiver& place) {
        return distant_chance(scene, seeing(shading::AllLayers), sun, place);
    };
    EXPECT_EQ(chance(receiver({}, -1.0f)), 0.2f / 3.0f);
    EXPECT_GT(chance(receiver({})), 0.2f);
    EXPECT_GT(chance({{}, {}, {}, shading::NoSkyCell}), 0.2f) << "in a medium";
}

// What is chosen has the probability that the other technique assumes.
TEST(LightChoice, FitsItsProbabilities) {
    House house;
    house.light({.kind = scene::LightKind::Directional, .intensity = glm::vec3(1.0f), .angle = 0.1f},
                glm::rotate(glm::dmat4(1.0), 1.0, {1.0, 0.0, 0.0}));
    const shading::Scene scene = backend::on_host(house.build().tables());
    ASSERT_EQ(scene.light_count - scene.tree_light_count, 3u);
    for (const Receiver& place :
         {receiver({}), receiver({0, 0, 2.9f}), receiver({5, 5, 0}, -1.0f), receiver({1e20f, 0, 0})}) {
        const shading::LightChances chances = chances_at(scene, place);
        std::vector<double> expected{chances.tree}, observed(4);
        for (std::uint32_t i = scene.tree_light_count; i < scene.light_count; ++i)
            expected.push_back(chance_of(chances, seeing(shading::AllLayers), scene.lights.items[i], place));
        EXPECT_NEAR(expected[0] + expected[1] + expected[2] + expected[3], 1.0, 1e-6);
        constexpr int Count = 100'000;
        for (int i = 0; i < Count; ++i) {
            const float u = (float(i) + 0.5f) / Count;
            const shading::ChosenLight chosen = choose_light(scene, seeing(shading::AllLayers), place, u);
            const bool in_tree = chosen.index < scene.tree_light_count;
            const std::size_t at = in_tree ? 0 : chosen.index - scene.tree_light_count + 1;
            ++observed[at];
            EXPECT_EQ(chosen.probability, float(expected[at]));
            if (in_tree) {
                EXPECT_NEAR(chosen.rest, u / chances.tree, 1e-6f);
            }
        }
        for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(observed[i] / Count, expected[i], 2e-5) << i;
    }
}

TEST(LightChoice, TakesNoSamplesForHiddenSuns) {
    House house;
    const shading::Scene scene = backend::on_host(house.build().tables());
    shading::Scene layered = scene;
    layered.features = shading::FeatureBits{scene.features.bits | shading::FeatureLayers};
    std::vector<shading::LightSource> lights(scene.lights.items, scene.lights.items + scene.light_count);
    lights[1].layers = 2;
    layered.lights.items = lights.data();
    for (int i = 0; i < 1000; ++i) {
        const float u = (float(i) + 0.5f) / 1000.0f;
        const shading::ChosenLight chosen = choose_light(layered, seeing(1), receiver({}), u);
        EXPECT_NE(chosen.index, 1u);
        EXPECT_GT(chosen.probability, 0.0f);
    }
    lights[0].layers = lights[1].layers = lights[2].layers = 2;
    layered.tree_light_count = 0;
    EXPECT_EQ(choose_light(layered, seeing(1), receiver({}), 0.5f).probability, 0.0f);
}

double variance_of(const SceneAdapter& world, const view::View& view, Strategy strategy, Mean& mean) {
    const PathTracer tracer(world.tables(), world.scene(), view, strategy);
    std::uint64_t rays = 0;
    double sum = 0, squares = 0;
    constexpr std::uint64_t Count = 256 * 256;
    for (std::uint64_t i = 0; i < Count; ++i) {
        const double value = red(tracer.trace(i % 16, i / 16 % 16, i / 256, rays));
        sum += value;
        squares += value * value;
    }
    const double average = sum / Count, variance = squares / Count - average * average;
    mean = {average, std::sqrt(std::max(variance, 0.0) / Count)};
    return variance;
}

// The overcast sky of the CIE, (1 + 2 sin of the height) / 3 above the horizon and black below, on a floor that faces up or
// sideways.
struct Overcast : Model {
    explicit Overcast(double turn) {
        constexpr std::uint32_t Width = 64, Height = 32;
        std::vector<glm::vec3> texels;
        for (std::uint32_t y = 0; y < Height; ++y) {
            const double theta = M_PI * (y + 0.5) / Height;
            const double value = theta < 0.5 * M_PI ? (1.0 + 2.0 * std::cos(theta)) / 3.0 : 0.0;
            texels.insert(texels.end(), Width, glm::vec3(static_cast<float>(value)));
        }
        scene::Background background{.strength = 1.0f};
        background.environment =
            texture({.width = Width, .height = Height, .format = scene::TexelFormat::RgbFloat}, texels)
                .texture;
        sky(background);
        const auto at = glm::rotate(glm::dmat4(1.0), turn, {1.0, 0.0, 0.0});
        set_frame(at);
        floor(material(chalk(glm::vec3(1.0f))), 1.0f, 0.0f);
        view = small_view(glm::dvec3(at * glm::dvec4(0.0, 0.0, 0.5, 1.0)), 1e-3, 16, at);
        view.max_bounces = 0;
    }
    view::View view;
};

// The relative variance was 0.086 on a floor that faces up when light samples looked for all of the sky.
TEST(SkySampling, IsLessNoisyThanBsdfSamplesAlone) {
    for (const auto& [turn, most] : {std::pair{-0.5 * M_PI, 0.025}, std::pair{0.0, 0.7}}) {
        Overcast overcast(turn);
        const SceneAdapter& world = overcast.build();
        Mean both, bsdf, lights;
        const double variance = variance_of(world, overcast.view, Strategy::Both, both);
        const double alone = variance_of(world, overcast.view, Strategy::BsdfOnly, bsdf);
        variance_of(world, overcast.view, Strategy::LightsOnly, lights);
        EXPECT_LT(variance / (both.value * both.value), most) << turn;
        EXPECT_LT(variance, 0.75 * alone) << turn;
        for (const Mean& other : {bsdf, lights}) {
            EXPECT_NEAR(both.value, other.value, 4.0 * std::hypot(both.standard_error, other.standard_error));
        }
    }
}

TEST(SkySampling, TracesNoShadowRaysToAnEvenSky) {
    for (const bool has_map : {false, true}) {
        Model model;
        scene::Background background{.color = glm::vec3(0.25f)};
        if (has_map) {
            background.strength = 3.0f;
            background.environment =
                model
                    .texture({.width = 4, .height = 2, .format = scene::TexelFormat::RgbFloat},
                             std::vector<glm::vec3>(8, glm::vec3(0.25f)))
                    .texture;
        }
        model.sky(background);
        model.floor(model.material(chalk(glm::vec3(0.5f))), 1.0f, 0.0f);
        const SceneAdapter& world = model.build();
        EXPECT_EQ(world.tables().lights.back().irradiance, 0.0f);
        view::View view = small_view({0.0, 0.0, 0.5}, 1e-3);
        const PathTracer tracer(world.tables(), world.scene(), view);
        std::uint64_t rays = 0;
        for (std::uint32_t i = 0; i < 256; ++i)
            EXPECT_NEAR(red(tracer.trace(i % 16, i / 16, 0, rays)), has_map ? 0.5 : 0.125, 1e-6);
        EXPECT_EQ(rays, 512u) << "from the camera and from the floor";
    }
}

}  // namespace
}  // namespace tessera::embree
