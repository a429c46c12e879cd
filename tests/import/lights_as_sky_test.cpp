#include "client/import/lights_as_sky.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

// Lights that are left out for speed, and the sky that takes their place.
namespace tessera::import {
namespace {

using std::numbers::pi;

// A mesh within a ball of radius 1 and three lights: a sun, and two lamps at a distance of 2 and 1000.
SceneFile lit_file(const std::string& sunlight = "4", const std::string& hard = "true") {
    SceneFile file;
    const float edge = 1.0f / std::sqrt(3.0f);
    const int at = file.positions({{-edge, -edge, -edge}, {edge, edge, edge}, {edge, -edge, edge}});
    file.add("meshes", R"({"primitives":[{"attributes":{"POSITION":)" + std::to_string(at) + "}}]}");
    file.set("extensionsUsed", R"(["KHR_lights_punctual"])");
    file.set("extensions", R"({"KHR_lights_punctual":{"lights":[
        {"type":"directional","name":"sun","intensity":)" +
                               sunlight + R"(,"color":[1,0.5,0.25],"extras":{"hard_shadow":)" + hard + R"(}},
        {"type":"point","name":"lamp","intensity":8,"extras":{"hard_shadow":false}},
        {"type":"spot","name":"spot","intensity":1e6,"extras":{"hard_shadow":0.0},
         "spot":{"innerConeAngle":0.2,"outerConeAngle":0.5}}]}})");
    file.add("nodes", R"({"mesh":0})");
    for (int light = 0; light < 3; ++light) {
        const std::string place = light == 1 ? "0,2,0" : light == 2 ? "1000,0,0" : "0,0,0";
        file.add("nodes", R"({"translation":[)" + place +
                              R"(],"extensions":{"KHR_lights_punctual":{"light":)" + std::to_string(light) +
                              "}}}");
    }
    file.add("scenes", R"({"nodes":[0,1,2,3]})");
    return file;
}

ImportedScene lit_scene(const ImportOptions& options) {
    const TestFolder folder;
    ImportedScene scene = loaded(folder.write("scene.glb", lit_file().glb()), options);
    expect_consistent(scene);
    expect_valid(scene);
    return scene;
}

glm::vec3 sky_of(const ImportedScene& scene) {
    return all<scene::Background>(scene).front()->color;
}

TEST(LightsAsSky, KeepsTheIrradianceOfASun) {
    ImportOptions options;
    options.lights_as_sky = {"sun"};
    options.background = glm::vec3(1.0f);
    const ImportedScene scene = lit_scene(options);
    EXPECT_EQ(scene.counts.lights, 2u);
    EXPECT_TRUE(has_notice(scene, "1 light is left out for speed"));
    const glm::vec3 sky = sky_of(scene);
    EXPECT_NEAR(sky.x, 1.0 + 1.0 / pi, 1e-6);
    EXPECT_NEAR(sky.y, 1.0 + 0.5 / pi, 1e-6);
    EXPECT_NEAR(sky.z, 1.0 + 0.25 / pi, 1e-6);
}

TEST(LightsAsSky, TakesThoseThatTheFileMarks) {
    ImportOptions options;
    options.soft_lights_as_sky = true;
    const ImportedScene scene = lit_scene(options);
    EXPECT_EQ(scene.counts.lights, 1u);
    const double lamp = 8.0 / (4.0 * pi) * 0.75 * (2.0 - 1.5 * std::log(3.0));
    const double solid_angle = 2.0 * pi * ((1.0 - std::cos(0.2)) + (std::cos(0.2) - std::cos(0.5)) / 3.0);
    const double spot = 1e6 / (4.0 * pi) * solid_angle / (4.0 * pi) / (1000.0 * 1000.0);
    EXPECT_NEAR(sky_of(scene).x, lamp + spot, 2e-6 * lamp + 2e-6 * spot);
    EXPECT_FALSE(all<scene::Background>(scene).front()->environment) << "the sky is the light now";
}

TEST(LightsAsSky, KeepsAllWithoutTheOptions) {
    const ImportedScene scene = lit_scene({});
    EXPECT_EQ(scene.counts.lights, 3u);
    EXPECT_EQ(sky_of(scene), glm::vec3(0.0f));
}

TEST(LightsAsSky, NamesWhatItCannotFind) {
    const TestFolder folder;
    ImportOptions options;
    options.lights_as_sky = {"moon"};
    const auto failed = import_scene(folder.write("scene.glb", lit_file().glb()), options);
    ASSERT_FALSE(failed);
    EXPECT_NE(std::string(failed.error().what())
                  .find("no light 'moon' to leave out: the lights are lamp, spot, sun"),
              std::string::npos)
        << failed.error().what();

    options.lights_as_sky = {"sun"};
    const auto blinding = import_scene(folder.write("bright.glb", lit_file("1e14").glb()), options);
    ASSERT_FALSE(blinding);
    EXPECT_NE(std::string(blinding.error().what()).find("too bright for a sky"), std::string::npos)
        << blinding.error().what();

    const auto saved = import_scene(folder.write("saved.tessera", "anything"), options);
    ASSERT_FALSE(saved);
    EXPECT_NE(std::string(saved.error().what()).find("not of saved scenes"), std::string::npos)
        << saved.error().what();

    SceneFile dark;
    dark.add_triangle();
    options = {};
    options.soft_lights_as_sky = true;
    EXPECT_TRUE(
        has_notice(loaded(folder.write("dark.glb", dark.glb()), options), "no light of it is marked"));
}

TEST(LightsAsSky, IgnoresMarksOfAnotherTypeWithANotice) {
    const TestFolder folder;
    ImportOptions options;
    options.soft_lights_as_sky = true;
    const ImportedScene scene = loaded(folder.write("scene.glb", lit_file("4", R"("no")").glb()), options);
    EXPECT_EQ(scene.counts.lights, 1u) << "the sun";
    EXPECT_TRUE(has_notice(scene, "light 'sun': its extra hard_shadow is neither a boolean nor a number"));
}

// Of its flux, pi x intensity, a quad has a quarter of a point light's.
TEST(LightsAsSky, CountsTheFluxOfQuads) {
    const Bounds bounds{glm::dvec3(-1.0), glm::dvec3(1.0)};
    const glm::dmat4 place = glm::translate(glm::dmat4(1.0), {0.0, 3.0, 0.0});
    const scene::Light point{.intensity = glm::vec3(1.0f)};
    const scene::Light quad{.kind = scene::LightKind::Quad, .intensity = glm::vec3(1.0f)};
    EXPECT_DOUBLE_EQ(radiance_as_sky(quad, place, bounds).x, 0.25 * radiance_as_sky(point, place, bounds).x);
}

// By a sum over a grid of the ball, from its center to far away; the light may be in it.
TEST(LightsAsSky, MeansOverTheSceneAreExact) {
    const Bounds bounds{glm::dvec3(-1.0 / std::sqrt(3.0)), glm::dvec3(1.0 / std::sqrt(3.0))};
    const scene::Light lamp{.intensity = glm::vec3(1.0f)};
    const auto found = [&](double distance) {
        const glm::dmat4 place = glm::translate(glm::dmat4(1.0), {0.0, 0.0, distance});
        return 4.0 * pi * radiance_as_sky(lamp, place, bounds).x;
    };
    for (const double distance : {0.3, 0.9, 1.5, 4.0}) {
        constexpr int Steps = 120;
        double sum = 0.0, count = 0.0;
        for (int i = 0; i < Steps * Steps * Steps; ++i) {
            const glm::dvec3 at =
                (glm::dvec3(i % Steps, i / Steps % Steps, i / Steps / Steps) + 0.5) * (2.0 / Steps) - 1.0;
            if (glm::dot(at, at) > 1.0) continue;
            const glm::dvec3 offset = at - glm::dvec3(0.0, 0.0, distance);
            sum += 1.0 / glm::dot(offset, offset);
            count += 1.0;
        }
        // The grid misses a part of what is next to the light.
        EXPECT_NEAR(found(distance), sum / count, (distance < 1.0 ? 0.012 : 0.002) * sum / count) << distance;
    }
    EXPECT_NEAR(found(0.0), 3.0, 1e-6);
    EXPECT_NEAR(found(1e-4), 3.0, 1e-6);
    EXPECT_NEAR(found(1.0), 1.5, 1e-6);
    EXPECT_NEAR(found(999.0) * 999.0 * 999.0, 1.0, 1e-4) << "no cancellation";
    EXPECT_NEAR(found(1e6) * 1e12, 1.0, 1e-9);
}

}  // namespace
}  // namespace tessera::import
