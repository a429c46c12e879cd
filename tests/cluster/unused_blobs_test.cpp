// Meshes and textures are freed while a scene lives, but not while an undo could bring them back.
#include <gtest/gtest.h>

#include <thread>

#include "mediator/scene/fields.h"
#include "tests/cluster/cluster_scene.h"
#include "tests/cluster/loopback_cluster.h"

namespace tessera::test {
namespace {

using namespace scene;
using namespace std::chrono_literals;

struct UnusedBlobs : testing::Test {
    static constexpr std::uint64_t Bytes = 1 << 20;
    LoopbackCluster cluster;
    std::shared_ptr<BlobStore> blobs = std::make_shared<BlobStore>();
    std::unique_ptr<client::Session> ann = cluster.member("ann", blobs);
    ObjectId texture, painted;

    void SetUp() override {
        texture = ann->new_id();
        painted = ann->new_id();
        const BlobPtr texels = blobs->insert(std::vector<std::byte>(Bytes, std::byte{77}));
        Texture large{.name = "large", .width = 512, .height = 512};
        large.format = TexelFormat::Rgba8;
        large.texels = reference(*texels);
        const auto created =
            ann->submit({Create{texture, large}, Create{painted, Material{.name = "painted"}}});
        ASSERT_TRUE(created.accepted) << created.problems.at(0);
        ASSERT_TRUE(ann->submit({Remove{texture}}).accepted);
    }
    std::uint64_t held() { return ann->status().blob_bytes; }
    void edit(int count) {
        for (int i = 0; i < count; ++i) {
            Material material{.base_color = {float(i % 7) / 7.0f, float(count) / 1000.0f, 0, 1}};
            ASSERT_TRUE(
                ann->submit({Update{painted, Fields<Material>(&Material::base_color).bits(), material}})
                    .accepted);
        }
    }
};

TEST_F(UnusedBlobs, StayWhileAnUndoCouldBringThemBack) {
    edit(10);
    std::this_thread::sleep_for(300ms);
    edit(1);
    std::this_thread::sleep_for(300ms);
    EXPECT_GE(held(), Bytes);
    for (int i = 0; i < 12; ++i) ASSERT_TRUE(ann->undo().accepted);
    ann->refresh();
    const auto* again = ann->scene().find_as<Texture>(texture);
    ASSERT_NE(again, nullptr);
    EXPECT_EQ(again->texels.byte_size, Bytes);
    EXPECT_GE(held(), Bytes);
}

TEST_F(UnusedBlobs, AreFreedOnceTheirUndoStepIsGone) {
    edit(300);  // the history has 256
    for (int i = 0; i < 200 && held() >= Bytes; ++i) {
        edit(1);
        std::this_thread::sleep_for(20ms);
    }
    EXPECT_LT(held(), Bytes);
    // The same texture again: it is sent again.
    const ObjectId again = ann->new_id();
    Texture large{.name = "again", .width = 512, .height = 512};
    large.format = TexelFormat::Rgba8;
    large.texels = reference(*blobs->insert(std::vector<std::byte>(Bytes, std::byte{77})));
    ASSERT_TRUE(ann->submit({Create{again, large}}).accepted);
    EXPECT_GE(held(), Bytes);
}

}  // namespace
}  // namespace tessera::test
