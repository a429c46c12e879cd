#include "node/scene_replica.h"

#include <gtest/gtest.h>

#include "tests/backend/scene_builder.h"

namespace tessera::node {
namespace {

using Verdict = SceneReplica::Verdict;

struct SceneReplicaTest : testing::Test {
    SceneReplicaTest() { replica.start_epoch(1); }
    scene::ChangeList camera(std::uint64_t id) {
        return builder.edit({scene::Create{ObjectId{id}, scene::Camera{}}});
    }
    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    SceneReplica replica{blobs};
    test::SceneBuilder builder;
};

TEST_F(SceneReplicaTest, OnlyTheNextVersionOrASnapshotIsAccepted) {
    const auto one = camera(2), two = camera(3), three = camera(4);
    EXPECT_EQ(replica.offer(one), Verdict::Accepted);
    EXPECT_EQ(replica.offer(one), Verdict::Duplicate);
    EXPECT_EQ(replica.offer(three), Verdict::Gap);
    EXPECT_EQ(replica.offer(two), Verdict::Accepted);
    EXPECT_EQ(replica.offer(one), Verdict::Duplicate);
    EXPECT_EQ(replica.offer(snapshot(builder.scene())), Verdict::Accepted);
    EXPECT_EQ(replica.offer(three), Verdict::Duplicate);
    EXPECT_EQ(replica.offer(snapshot(builder.scene())), Verdict::Duplicate);

    scene::ChangeList jump = camera(5);  // a list that claims to lead two versions on
    ++jump.to.number;
    EXPECT_EQ(replica.offer(jump), Verdict::Gap);
    scene::ChangeList foreign = snapshot(builder.scene());
    foreign.to.epoch = 2;
    EXPECT_EQ(replica.offer(foreign), Verdict::Gap);
}

TEST_F(SceneReplicaTest, AVersionCountsOnlyWhenItIsBuilt) {
    const auto one = camera(2);
    replica.offer(one);
    ASSERT_TRUE(replica.advance());
    EXPECT_EQ(replica.version(), Version{});
    EXPECT_TRUE(replica.is_behind());
    ASSERT_TRUE(replica.take_build());
    EXPECT_FALSE(replica.take_build());
    EXPECT_TRUE(replica.built());
    EXPECT_EQ(replica.version(), one.to);
    EXPECT_EQ(replica.state_hash(), builder.scene().state_hash());
    EXPECT_FALSE(replica.is_behind());
}

TEST_F(SceneReplicaTest, ABuildOfAnEpochThatIsOverMeansNothing) {
    replica.offer(camera(2));
    ASSERT_TRUE(replica.advance());
    ASSERT_TRUE(replica.take_build());
    replica.start_epoch(2);
    EXPECT_TRUE(replica.is_building());
    EXPECT_FALSE(replica.built());
    EXPECT_EQ(replica.version(), Version{});
}

TEST_F(SceneReplicaTest, AListWaitsForItsOwnBlobsButNotForThoseOfLaterOnes) {
    scene::Geometry geometry;
    geometry.positions = {blake2b({}), 12};
    const auto one = camera(2), two = builder.edit({scene::Create{ObjectId{3}, geometry}});
    replica.offer(one);
    replica.offer(two);
    ASSERT_TRUE(replica.advance());
    EXPECT_EQ(replica.missing(), std::vector{geometry.positions});
    const auto build = replica.take_build();
    ASSERT_TRUE(build);
    EXPECT_EQ(build->to, one.to);
    EXPECT_TRUE(build->unchecked.empty());
}

TEST_F(SceneReplicaTest, ASnapshotMakesEarlierListsAndTheirBlobsPointless) {
    scene::Geometry geometry;
    geometry.positions = {blake2b({}), 12};
    replica.offer(builder.edit({scene::Create{ObjectId{3}, geometry}}));
    ASSERT_TRUE(replica.advance());
    builder.edit({scene::Remove{ObjectId{3}}});
    EXPECT_EQ(replica.offer(snapshot(builder.scene())), Verdict::Accepted);
    ASSERT_TRUE(replica.advance());
    EXPECT_TRUE(replica.missing().empty());
    EXPECT_TRUE(replica.take_build());
}

}  // namespace
}  // namespace tessera::node
