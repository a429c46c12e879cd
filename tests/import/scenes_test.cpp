#include <cmath>
#include <fstream>

#include "mediator/base/random.h"
#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"
#include "tests/support/folders.h"

// The scenes and environments in tests/scenes.
namespace tessera::import {
namespace {

TEST(Scenes, TheRoom) {
    const ImportedScene scene = loaded(test::scenes_folder() / "room-1.glb");
    expect_consistent(scene);
    expect_valid(scene);
    EXPECT_NEAR(static_cast<double>(scene.counts.triangles), 79e3, 1e3);
    EXPECT_EQ(scene.counts.instances, 12u);
    EXPECT_EQ(scene.counts.emissive_geometries, 1u);
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.cameras[0].name, "camera");
    EXPECT_NEAR(scene.cameras[0].world_from_camera[3].z, 3.6, 1e-6);
    EXPECT_EQ(scene.counts.textures, 1u);
    EXPECT_EQ(scene.counts.placeholders, 0u);
    EXPECT_TRUE(scene.notices.empty()) << scene.notices.front();
}

TEST(Scenes, TheStudio) {
    const ImportedScene scene = loaded(test::scenes_folder() / "studio-1.glb");
    expect_consistent(scene);
    expect_valid(scene);
    EXPECT_NEAR(static_cast<double>(scene.counts.triangles), 25e3, 1e3);
    EXPECT_EQ(scene.counts.emissive_geometries, 2u);
    EXPECT_EQ(scene.cameras[0].name, "camera");
    EXPECT_EQ(scene.counts.placeholders, 0u);
}

TEST(Scenes, TheStillLifeIsLitByTheGivenEnvironment) {
    ImportOptions options;
    const ImportedScene dark = loaded(test::scenes_folder() / "still.glb");
    expect_consistent(dark);
    expect_valid(dark);
    EXPECT_NEAR(static_cast<double>(dark.counts.triangles), 9e3, 1e3);
    EXPECT_TRUE(has_notice(dark, "default environment"));

    for (const char* name : {"env-studio.exr", "env-sunset.exr", "env-night.exr"}) {
        options.environment = test::scenes_folder() / name;
        options.environment_strength = 2.0f;
        options.environment_rotation = 0.5f;
        const ImportedScene scene = loaded(test::scenes_folder() / "still.glb", options);
        expect_consistent(scene);
        expect_valid(scene);
        EXPECT_FALSE(has_notice(scene, "default environment"));
        const scene::Background& background = *all<scene::Background>(scene)[0];
        EXPECT_EQ(background.strength, 2.0f);
        EXPECT_EQ(background.rotation, 0.5f);
        EXPECT_EQ(background.map_center, scene::MapCenter::PositiveX);
        const auto& map = object<scene::Texture>(scene, background.environment);
        EXPECT_EQ(map.width, 512u);
        EXPECT_EQ(map.height, 256u);
        EXPECT_EQ(map.format, scene::TexelFormat::RgbFloat);
        float peak = 0.0f;
        for (const float value : values<float>(scene, map.texels)) {
            ASSERT_TRUE(std::isfinite(value) && value >= 0.0f);
            peak = std::max(peak, value);
        }
        EXPECT_GT(peak, 1.0f) << "radiance, not a picture";
    }
}

TEST(Scenes, AnInvalidEnvironmentIsAnErrorThatNamesIt) {
    ImportOptions options;
    options.environment = test::scenes_folder() / "still.glb";
    const auto refused = import_scene(test::scenes_folder() / "still.glb", options);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code(), ErrorCode::InvalidInput);
    EXPECT_THAT(refused.error().what(), testing::HasSubstr("environment"));
}

TEST(Scenes, ARadianceImageIsAnEnvironmentToo) {
    const TestFolder folder;
    ImportOptions options;
    std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n";
    for (int i = 0; i < 8; ++i) hdr += "\x80\x40\x20\x82";  // 2^(130 - 136) * (128, 64, 32)
    options.environment = folder.write("sky.hdr", hdr);
    const ImportedScene scene = loaded(test::scenes_folder() / "still.glb", options);
    expect_consistent(scene);
    const auto& map = object<scene::Texture>(scene, all<scene::Background>(scene)[0]->environment);
    EXPECT_EQ(map.width, 4u);
    EXPECT_EQ(map.height, 2u);
    EXPECT_THAT(values<glm::vec3>(scene, map.texels), testing::Each(glm::vec3(2.0f, 1.0f, 0.5f)));
}

TEST(Scenes, DamagedEnvironmentsAreErrorsOrMaps) {
    std::ifstream stream(test::scenes_folder() / "env-studio.exr", std::ios::binary);
    const std::string whole((std::istreambuf_iterator<char>(stream)), {});
    ASSERT_GT(whole.size(), 1000u);
    const TestFolder folder;
    ImportOptions options;
    const auto survives = [&](const std::string& bytes) {
        options.environment = folder.write("sky.exr", bytes);
        const auto scene = import_scene(test::scenes_folder() / "still.glb", options);
        if (!scene) {
            EXPECT_THAT(scene.error().what(), testing::HasSubstr("sky.exr"));
            EXPECT_EQ(scene.error().code(), ErrorCode::InvalidInput);
        }
        return scene.has_value();
    };
    EXPECT_TRUE(survives(whole));
    for (const std::size_t length : {std::size_t{0}, std::size_t{10}, std::size_t{200}, whole.size() / 2}) {
        EXPECT_FALSE(survives(whole.substr(0, length))) << length;
    }
    CounterRandom random(31);
    int refused = 0;
    for (int round = 0; round < 60; ++round) {
        std::string damaged = whole;
        char& byte = damaged[random.below(round % 2 ? 600 : damaged.size())];  // the header, or anywhere
        byte = static_cast<char>(byte ^ (1 << random.below(8)));
        SCOPED_TRACE("round " + std::to_string(round));
        refused += survives(damaged) ? 0 : 1;
    }
    EXPECT_GT(refused, 5);
}

}  // namespace
}  // namespace tessera::import
