#include <sys/stat.h>

#include <fstream>

#include "client/export/export.h"
#include "client/import/tessera_format.h"
#include "tests/export/rich_scene.h"
#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

namespace tessera::exporting {
namespace {

class TesseraFileTest : public testing::Test {
  protected:
    void SetUp() override {
        make_rich(rich_);
        const auto written = write_tessera(rich_.scene, rich_.blobs, file_);
        ASSERT_TRUE(written) << written.error().what();
        EXPECT_TRUE(written->empty());
    }

    import::TestFolder folder_;
    std::filesystem::path file_ = folder_.path() / "scene.tessera";
    RichScene rich_;
};

TEST_F(TesseraFileTest, KeepsEverythingBitExact) {
    const auto read = import::read_tessera(file_);
    ASSERT_TRUE(read) << read.error().what();
    scene::Scene scene;
    ASSERT_TRUE(scene.apply(read->snapshot));
    EXPECT_EQ(scene.state_hash(), rich_.scene.state_hash());
    EXPECT_EQ(scene.version(), rich_.scene.version());
    EXPECT_EQ(scene.objects().size(), rich_.scene.objects().size());
    EXPECT_EQ(read->blobs.size(), rich_.blobs.count());
    for (const scene::BlobPtr& blob : read->blobs) EXPECT_TRUE(rich_.blobs.find(blob->hash()));
}

TEST_F(TesseraFileTest, TheImporterGivesTheSameSceneFromTheSameFirstId) {
    const import::ImportedScene imported = import::loaded(file_);
    scene::Scene scene;
    ASSERT_TRUE(scene.apply_entries(entries(imported, import::RootEntry::Create)));
    EXPECT_EQ(scene.state_hash(), rich_.scene.state_hash());
    EXPECT_TRUE(imported.notices.empty());
    ASSERT_EQ(imported.cameras.size(), 1u);
    EXPECT_EQ(imported.cameras[0].name, "front");
    EXPECT_EQ(imported.counts.instances, 5u) << "the wheel twice with two, and one at the root";
    EXPECT_EQ(imported.counts.lights, 3u);
    EXPECT_EQ(imported.counts.geometries, 2u);
    EXPECT_EQ(imported.counts.triangles, 4u);
}

TEST_F(TesseraFileTest, OtherIdsChangeNothingButIds) {
    import::ImportOptions options;
    options.first_id = ObjectId{70000};
    const import::ImportedScene imported = import::loaded(file_, options);
    ASSERT_EQ(imported.objects.size() + 1, rich_.scene.objects().size());
    for (std::size_t i = 0; i < imported.objects.size(); ++i) {
        EXPECT_EQ(imported.objects[i].id.value, 70000 + i);
        EXPECT_EQ(scene::name(imported.objects[i].object), scene::name(*rich_.scene.find(ObjectId{2 + i})));
    }
    const auto& wheel = import::named<scene::Transform>(imported, "wheel");
    EXPECT_EQ(import::object<scene::Geometry>(imported, wheel.children[0]).name, "square");
    EXPECT_FALSE(import::object<scene::Geometry>(imported, wheel.children[1]).material);
    EXPECT_EQ(imported.root.children.size(), 3u);
}

TEST_F(TesseraFileTest, TooFewIdsAreAnError) {
    import::ImportOptions options;
    options.first_id = ObjectId{100};
    options.end_id = ObjectId{105};
    const auto imported = import::import_scene(file_, options);
    ASSERT_FALSE(imported);
    EXPECT_THAT(imported.error().what(), testing::HasSubstr("more than the 5 objects"));
}

TEST_F(TesseraFileTest, OptionsReplaceTheBackground) {
    import::ImportOptions options;
    options.background = glm::vec3(0.1f, 0.2f, 0.3f);
    const import::ImportedScene imported = import::loaded(file_, options);
    EXPECT_EQ(import::named<scene::Background>(imported, "evening").color, *options.background);
}

TEST_F(TesseraFileTest, ASceneWithoutACameraGetsOneIfAskedFor) {
    scene::Scene bare;
    ASSERT_TRUE(bare.apply_entries({scene::Create{scene::RootId, scene::Root{}}}));
    ASSERT_TRUE(write_tessera(bare, rich_.blobs, file_));
    EXPECT_EQ(import::loaded(file_).cameras.size(), 1u);
    import::ImportOptions options;
    options.missing = import::Missing::Leave;
    const import::ImportedScene left = import::loaded(file_, options);
    EXPECT_TRUE(left.cameras.empty());
    EXPECT_TRUE(left.objects.empty());
}

TEST_F(TesseraFileTest, AMissingBlobIsAnErrorAndTheOldFileStays) {
    const auto before = std::filesystem::file_size(file_);
    const scene::BlobStore empty;
    for (const char* name : {"scene.tessera", "other.tessera", "other.glb"}) {
        const auto written = write_scene(rich_.scene, empty, folder_.path() / name);
        ASSERT_FALSE(written);
        EXPECT_EQ(written.error().code(), ErrorCode::NotFound);
    }
    EXPECT_EQ(std::filesystem::file_size(file_), before);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1) << "no leftovers";
}

TEST_F(TesseraFileTest, AMissingFolderIsAnError) {
    const auto written = write_scene(rich_.scene, rich_.blobs, folder_.path() / "no" / "where.tessera");
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code(), ErrorCode::Io);
    EXPECT_THAT(written.error().what(), testing::HasSubstr("check the folder"));
}

TEST_F(TesseraFileTest, OtherExtensionsAreRejected) {
    const auto written = write_scene(rich_.scene, rich_.blobs, folder_.path() / "scene.obj");
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code(), ErrorCode::InvalidInput);
}

}  // namespace
}  // namespace tessera::exporting
