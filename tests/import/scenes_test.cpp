#include <cmath>

#include "mediator/scene/validate.h"
#include "tests/import/inspect.h"

// The scenes and environments that come with the project.
namespace tessera::import {
namespace {

const std::filesystem::path Scenes = TESSERA_SCENES;

void expect_valid(const ImportedScene& imported) {
    scene::Scene scene;
    ASSERT_TRUE(scene.apply_entries(entries(imported, RootEntry::Create)));
    scene::BlobStore blobs;
    for (const scene::BlobPtr& blob : imported.blobs) blobs.insert(blob);
    for (const scene::Problem& problem : scene::validate(scene)) ADD_FAILURE() << problem.message;
    for (const auto& [id, object] : scene.objects()) {
        for (const scene::Problem& problem : scene::validate_blobs(id, *object, blobs)) {
            ADD_FAILURE() << problem.message;
        }
    }
}

TEST(Scenes, TheRoom) {
    const ImportedScene scene = loaded(Scenes / "room-1.glb");
    expect_sound(scene);
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
    const ImportedScene scene = loaded(Scenes / "studio-1.glb");
    expect_sound(scene);
    expect_valid(scene);
    EXPECT_NEAR(static_cast<double>(scene.counts.triangles), 25e3, 1e3);
    EXPECT_EQ(scene.counts.emissive_geometries, 2u);
    EXPECT_EQ(scene.cameras[0].name, "camera");
    EXPECT_EQ(scene.counts.placeholders, 0u);
}

TEST(Scenes, TheStillLifeIsLitByWhatTheUserBrings) {
    ImportOptions options;
    const ImportedScene dark = loaded(Scenes / "still.glb");
    expect_sound(dark);
    expect_valid(dark);
    EXPECT_NEAR(static_cast<double>(dark.counts.triangles), 9e3, 1e3);
    EXPECT_TRUE(has_notice(dark, "soft sky"));

    for (const char* name : {"env-studio.exr", "env-sunset.exr", "env-night.exr"}) {
        options.environment = Scenes / name;
        options.environment_strength = 2.0f;
        const ImportedScene scene = loaded(Scenes / "still.glb", options);
        expect_sound(scene);
        expect_valid(scene);
        EXPECT_FALSE(has_notice(scene, "soft sky"));
        const scene::Background& background = *all<scene::Background>(scene)[0];
        EXPECT_EQ(background.strength, 2.0f);
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

TEST(Scenes, AnEnvironmentThatIsNoPictureIsAnErrorThatNamesIt) {
    ImportOptions options;
    options.environment = Scenes / "still.glb";
    const auto refused = import_scene(Scenes / "still.glb", options);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code(), ErrorCode::InvalidInput);
    EXPECT_THAT(refused.error().what(), testing::HasSubstr("environment"));
}

}  // namespace
}  // namespace tessera::import
