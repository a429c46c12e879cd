#include "mediator/scene/scene_editor.h"

#include <gtest/gtest.h>

namespace tessera::scene {
namespace {

constexpr ObjectId Lamp{100}, Other{101};

struct SceneEditorTest : testing::Test {
    Scene base;
    void SetUp() override {
        ASSERT_TRUE(base.apply_entries({Create{RootId, Root{}}, Create{Lamp, Light{.name = "lamp"}}}));
    }
    static Light intense(float value) { return {.intensity = glm::vec3(value)}; }
    static constexpr Fields<Light> Intensity{&Light::intensity};
};

TEST_F(SceneEditorTest, ManyWritesOfAFieldAreOneEntry) {
    SceneEditor editor(base);
    for (int i = 0; i < 10; ++i) editor.update(Lamp, Intensity, intense(static_cast<float>(i + 2)));
    const auto entries = editor.take();
    ASSERT_EQ(entries.size(), 1u);
    const auto& update = std::get<Update>(entries[0]);
    EXPECT_EQ(update.mask, Intensity.bits());
    EXPECT_EQ(std::get<Light>(update.fields).intensity.x, 11.0f);
    EXPECT_TRUE(editor.empty());
}

TEST_F(SceneEditorTest, CreateAndUpdateIsACreate) {
    SceneEditor editor(base);
    editor.create(Other, Light{});
    editor.update(Other, Intensity, intense(7.0f));
    const auto entries = editor.take();
    ASSERT_EQ(entries.size(), 1u);
    EXPECT_EQ(std::get<Light>(std::get<Create>(entries[0]).object).intensity.x, 7.0f);
}

TEST_F(SceneEditorTest, CreateAndRemoveIsNothing) {
    SceneEditor editor(base);
    editor.create(Other, Light{});
    editor.remove(Other);
    EXPECT_TRUE(editor.take().empty());
}

TEST_F(SceneEditorTest, RemoveAndCreateOfTheSameKindIsAnUpdate) {
    SceneEditor editor(base);
    editor.remove(Lamp);
    editor.create(Lamp, Light{.name = "lamp", .intensity = glm::vec3(9.0f)});
    const auto entries = editor.take();
    ASSERT_EQ(entries.size(), 1u);
    EXPECT_EQ(std::get<Update>(entries[0]).mask, Intensity.bits());
    editor.remove(Lamp);
    editor.create(Lamp, Camera{});
    EXPECT_EQ(editor.take().size(), 2u) << "another kind: it goes and comes";
}

TEST_F(SceneEditorTest, WritesThatChangeNothingAreDropped) {
    SceneEditor editor(base);
    editor.update(Lamp, Intensity, intense(1.0f));
    EXPECT_TRUE(editor.take().empty());
}

TEST_F(SceneEditorTest, RejectsMissingObjectsAndOtherKinds) {
    SceneEditor editor(base);
    EXPECT_THROW(editor.remove(Other), Error);
    EXPECT_THROW(editor.create(Lamp, Light{}), Error);
    EXPECT_THROW(editor.update(Lamp, Fields<Camera>(&Camera::vertical_fov), Camera{}), Error);
    EXPECT_THROW(editor.update(Other, Intensity, Light{}), Error);
    EXPECT_TRUE(editor.take().empty());
}

}  // namespace
}  // namespace tessera::scene
