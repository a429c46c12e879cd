// Scenes that another thread encodes, read and mirrored while they change.
#include <gtest/gtest.h>

#include <thread>

#include "mediator/scene/fields.h"
#include "mediator/view/placed_cameras.h"
#include "tests/cluster/cluster_scene.h"
#include "tests/cluster/loopback_cluster.h"

namespace tessera::test {
namespace {

using namespace scene;
using namespace std::chrono_literals;

struct LargeScenes : testing::Test {
    static constexpr int Objects = 3000;
    LoopbackCluster cluster;
    std::shared_ptr<BlobStore> blobs = std::make_shared<BlobStore>();
    std::unique_ptr<client::Session> ann = cluster.member("ann", blobs);
    ObjectId moving, camera;

    void SetUp() override {
        const ObjectId first = ann->new_id();
        for (int i = 0; i < 3; ++i) (void)ann->new_id();
        ASSERT_TRUE(ann->submit(scene_entries(first, *blobs)).accepted);
        std::vector<Entry> many;
        Transform group{.name = "group"};
        for (int i = 0; i < Objects; ++i) {
            group.children.push_back(ann->new_id());
            many.push_back(Create{group.children.back(), Transform{.name = "part " + std::to_string(i)}});
        }
        moving = group.children.front();
        camera = ann->new_id();
        many.push_back(Create{camera, Camera{.name = "eye"}});
        group.children.push_back(camera);
        group.matrix[3] = {1, 2, 3, 1};
        const ObjectId above = ann->new_id();
        many.push_back(Create{above, group});
        ann->refresh();
        Root root = *ann->scene().find_as<Root>(RootId);
        root.children.push_back(above);
        many.push_back(Update{RootId, Fields<Root>(&Root::children).bits(), root});
        const auto result = ann->submit(std::move(many));
        ASSERT_TRUE(result.accepted) << result.problems.at(0);
    }
    void move(int step) {
        Transform moved;
        moved.matrix[3] = {step, 0, 0, 1};
        ASSERT_TRUE(
            ann->submit({Update{moving, Fields<Transform>(&Transform::matrix).bits(), moved}}).accepted);
    }
    bool all_nodes_are_current() const {
        const auto status = ann->status();
        return std::all_of(status.nodes.begin(), status.nodes.end(),
                           [&](const auto& node) { return node.version == status.version; });
    }
};

TEST_F(LargeScenes, ReachNodesAndReadersThatJoinWhileTheyChange) {
    std::vector<std::unique_ptr<client::Session>> readers;
    for (int step = 0; step < 40; ++step) {
        move(step);
        if (step % 10 == 0) cluster.add_node("null");
        if (step % 8 == 0) readers.push_back(cluster.member("reader", std::make_shared<BlobStore>()));
        std::this_thread::sleep_for(5ms);
    }
    ann->refresh();
    for (const auto& reader : readers) {
        reader->refresh();
        EXPECT_EQ(reader->scene().version(), ann->scene().version());
        EXPECT_EQ(reader->scene().state_hash(), ann->scene().state_hash());
        EXPECT_GT(reader->scene().objects().size(), std::size_t{Objects});
    }
    for (int i = 0; i < 500 && !all_nodes_are_current(); ++i) std::this_thread::sleep_for(10ms);
    EXPECT_TRUE(all_nodes_are_current());
    EXPECT_EQ(ann->status().nodes.size(), 4u);
}

TEST_F(LargeScenes, LongEditsReachNodesInOrderWithShortOnes) {
    cluster.add_node("null");
    for (int round = 0; round < 5; ++round) {
        std::vector<Entry> many;
        for (int i = 0; i < 1000; ++i)
            many.push_back(Create{ann->new_id(), Material{.name = "material " + std::to_string(i)}});
        ASSERT_TRUE(ann->submit(std::move(many)).accepted);
        for (int step = 0; step < 5; ++step) {
            move(10 * round + step);
            std::this_thread::sleep_for(10ms);
        }
    }
    for (int i = 0; i < 500 && !all_nodes_are_current(); ++i) std::this_thread::sleep_for(10ms);
    EXPECT_TRUE(all_nodes_are_current());
}

TEST_F(LargeScenes, ViewersReadTheCamerasWithTheirPlaces) {
    const auto viewer = cluster.member("viewer", std::make_shared<BlobStore>(), net::Role::Viewer);
    ann->refresh();
    EXPECT_EQ(viewer->scene().objects().size(), 3u) << "the root, the group and its camera";
    const auto seen = view::choose_camera(viewer->scene(), "eye"),
               real = view::choose_camera(ann->scene(), "eye");
    ASSERT_TRUE(seen && real);
    EXPECT_EQ(seen->world_from_camera, real->world_from_camera);
    EXPECT_EQ(seen->id, real->id);
    move(3);
    viewer->refresh();
    EXPECT_EQ(viewer->scene().objects().size(), 3u);
}

}  // namespace
}  // namespace tessera::test
