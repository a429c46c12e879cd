#include "client/export/export.h"
#include "client/import/import.h"
#include "client/import/tessera_format.h"
#include "tests/edit/fake_target.h"
#include "tests/import/animated_file.h"
#include "tests/import/scene_file.h"

namespace tessera::edit {
namespace {

using testing::HasSubstr;

class EditFiles : public testing::Test {
  protected:
    std::string at(const std::string& name) const { return quoted((folder_.path() / name).string()); }
    static std::string quoted(const std::string& name) { return "\"" + name + "\""; }
    std::string triangle() {
        import::SceneFile file;
        file.add_triangle();
        return quoted(folder_.write("my triangle.glb", file.glb()).string());
    }
    FakeTarget target_;
    import::TestFolder folder_;
};

TEST_F(EditFiles, SaveWritesTheScene) {
    ASSERT_TRUE(target_.script("save " + at("a b.tessera"))) << target_.error();
    EXPECT_THAT(target_.printed(), testing::StartsWith("saved '"));
    const auto read = import::read_tessera(folder_.path() / "a b.tessera");
    ASSERT_TRUE(read) << read.error().what();
    EXPECT_EQ(read->snapshot.state_hash, target_.scene().state_hash());
    ASSERT_TRUE(target_.script("save " + at("a.glb")));
    EXPECT_THAT(target_.printed(), HasSubstr("the background is left out"));
    EXPECT_TRUE(import::import_scene(folder_.path() / "a.glb"));
}

TEST_F(EditFiles, SaveReportsErrors) {
    EXPECT_FALSE(target_.script("save " + at("a.obj")));
    EXPECT_THAT(target_.error(), HasSubstr("test.txt:1:6: "));
    EXPECT_FALSE(target_.script("set lights/bulb.intensity 1\ncommit\nsave " + at("no/a.glb")));
    EXPECT_THAT(target_.error(), HasSubstr("test.txt:3:1: cannot write"));
    EXPECT_EQ(target_.named<scene::Light>("bulb").intensity, glm::vec3(3.0f, 2.0f, 0.1f))
        << "a script is all or nothing";
}

TEST_F(EditFiles, LoadImportsAFileUnderATransform) {
    const std::size_t before = target_.scene().objects().size();
    ASSERT_TRUE(
        target_.script("load " + triangle() + " in transforms/left\nmove transforms/\"my triangle\" 1 0 0"))
        << target_.error();
    EXPECT_THAT(target_.printed(), HasSubstr("transforms/\"my triangle\": 1 triangles in 1 geometries\n"));
    EXPECT_EQ(target_.scene().objects().size(), before + 4)
        << "transform, node, mesh, material; no camera, no sky";
    EXPECT_EQ(target_.named<scene::Transform>("my triangle").matrix[3][0], 1.0);
    EXPECT_EQ(target_.named<scene::Transform>("left").children.back(), target_.id_of("my triangle"));
    EXPECT_EQ(target_.scene().find_as<scene::Root>(scene::RootId)->background, target_.id_of("evening"));
    EXPECT_EQ(target_.labels.size(), 1u);
}

TEST_F(EditFiles, LoadPosesAFileAtATime) {
    const std::string file = quoted(folder_.write("moving.glb", import::moving_file().glb()).string());
    ASSERT_TRUE(target_.script("load " + file)) << target_.error();
    EXPECT_EQ(target_.named<scene::Transform>("cart").matrix[3][0], 0.0) << "at rest";
    FakeTarget posed;
    ASSERT_TRUE(posed.script("load " + file + " at=1.5 in transforms/left")) << posed.error();
    EXPECT_NEAR(posed.named<scene::Transform>("cart").matrix[3][0], 7.5, 1e-6) << "10 m in 2 s";
    for (const char* wrong : {"at=soon", "at=", "at=nan", "1.5", "at=1.5s"}) {
        EXPECT_FALSE(target_.script("load " + file + " " + wrong)) << wrong;
        EXPECT_THAT(target_.error(), HasSubstr("write at=SECONDS")) << wrong;
    }
    EXPECT_FALSE(target_.script("load " + file + " at=1 at=2"));
    EXPECT_THAT(target_.error(), HasSubstr("unexpected argument 'at=2'"));
}

TEST_F(EditFiles, LoadingAFileTwiceCreatesTwoCopies) {
    const std::string line = "load " + triangle() + "\n";
    ASSERT_TRUE(target_.script(line + line)) << target_.error();
    EXPECT_FALSE(target_.script("show transforms/\"my triangle\""));
    EXPECT_THAT(target_.error(), HasSubstr("2 transforms are named 'my triangle'"));
}

TEST_F(EditFiles, EmptySceneGetsALightAndACamera) {
    ASSERT_TRUE(
        target_.script("remove -r transforms/left\nremove -r transforms/@15\nremove -r geometries/square\n"
                       "remove -r backgrounds/evening"))
        << target_.error();
    ASSERT_EQ(target_.scene().objects().size(), 1u) << "the root";
    ASSERT_TRUE(target_.script("load " + triangle())) << target_.error();
    const auto& root = *target_.scene().find_as<scene::Root>(scene::RootId);
    EXPECT_EQ(root.children.size(), 1u);
    EXPECT_TRUE(target_.scene().find_as<scene::Background>(root.background)->environment)
        << "the default environment";
    target_.named<scene::Camera>("framing");
}

TEST_F(EditFiles, SavedSceneLoadsWithItsArrays) {
    ASSERT_TRUE(target_.script("load " + triangle() + "\nsave " + at("all.tessera"))) << target_.error();
    ASSERT_TRUE(target_.script("load " + at("all.tessera") + " in transforms/left")) << target_.error();
    const std::size_t count = target_.scene().objects().size();
    EXPECT_EQ(count, 2 * (17 - 1 + 3) + 1 + 1 - 2) << "all but root, background and its map twice";
}

TEST_F(EditFiles, FailedLoadChangesNothing) {
    const Hash128 before = target_.scene().state_hash();
    EXPECT_FALSE(target_.script("load nowhere.glb"));
    EXPECT_THAT(target_.error(), HasSubstr("test.txt:1:6: scene 'nowhere.glb': there is no such file"));
    EXPECT_FALSE(target_.script("load " + quoted(folder_.write("bad.tessera", "bad").string())));
    EXPECT_FALSE(target_.script("load a b"));
    EXPECT_EQ(target_.scene().state_hash(), before);
}

}  // namespace
}  // namespace tessera::edit
