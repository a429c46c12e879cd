#include "node/scene_replica.h"

#include <gtest/gtest.h>

#include "mediator/backend/catalog.h"
#include "tests/backend/scene_builder.h"

namespace tessera::node {
namespace {

using CheckResult = SceneReplica::CheckResult;

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
    EXPECT_EQ(replica.receive(one), CheckResult::Accepted);
    EXPECT_EQ(replica.receive(one), CheckResult::Duplicate);
    EXPECT_EQ(replica.receive(three), CheckResult::Gap);
    EXPECT_EQ(replica.receive(two), CheckResult::Accepted);
    EXPECT_EQ(replica.receive(one), CheckResult::Duplicate);
    EXPECT_EQ(replica.receive(snapshot(builder.scene())), CheckResult::Accepted);
    EXPECT_EQ(replica.receive(three), CheckResult::Duplicate);
    EXPECT_EQ(replica.receive(snapshot(builder.scene())), CheckResult::Duplicate);

    scene::ChangeList jump = camera(5);  // a list that claims to lead two versions on
    ++jump.to.number;
    EXPECT_EQ(replica.receive(jump), CheckResult::Gap);
    scene::ChangeList foreign = snapshot(builder.scene());
    foreign.to.epoch = 2;
    EXPECT_EQ(replica.receive(foreign), CheckResult::Gap);
}

TEST_F(SceneReplicaTest, AVersionCountsOnlyWhenItIsBuilt) {
    const auto one = camera(2);
    replica.receive(one);
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

TEST_F(SceneReplicaTest, ABuildOfAnOldEpochIsIgnored) {
    replica.receive(camera(2));
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
    replica.receive(one);
    replica.receive(two);
    ASSERT_TRUE(replica.advance());
    EXPECT_EQ(replica.missing(), std::vector{geometry.positions});
    const auto build = replica.take_build();
    ASSERT_TRUE(build);
    EXPECT_EQ(build->scene().version(), one.to);
    EXPECT_TRUE(build->unchecked.empty());
}

TEST_F(SceneReplicaTest, ASnapshotSupersedesEarlierListsAndTheirBlobs) {
    scene::Geometry geometry;
    geometry.positions = {blake2b({}), 12};
    replica.receive(builder.edit({scene::Create{ObjectId{3}, geometry}}));
    ASSERT_TRUE(replica.advance());
    builder.edit({scene::Remove{ObjectId{3}}});
    EXPECT_EQ(replica.receive(snapshot(builder.scene())), CheckResult::Accepted);
    ASSERT_TRUE(replica.advance());
    EXPECT_TRUE(replica.missing().empty());
    EXPECT_TRUE(replica.take_build());
}

TEST_F(SceneReplicaTest, ABlobThatALaterListReleasesIsNotWaitedFor) {
    const auto bytes = [](unsigned char value) { return std::vector<std::byte>(12, std::byte(value)); };
    scene::Geometry old, now;
    old.positions = {blake2b(bytes(1)), 12};
    now.positions = {blake2b(bytes(2)), 12};
    const scene::Fields<scene::Geometry> shape{&scene::Geometry::positions};
    replica.receive(builder.edit({scene::Create{ObjectId{3}, old}}));
    replica.receive(builder.edit({test::SceneBuilder::update(ObjectId{3}, shape, now)}));
    const auto last = builder.edit({scene::Create{ObjectId{4}, old}, scene::Remove{ObjectId{4}}});
    replica.receive(last);
    ASSERT_TRUE(replica.advance());
    EXPECT_EQ(replica.missing(), std::vector{now.positions});
    EXPECT_FALSE(replica.take_build());
    blobs->insert(bytes(2));
    EXPECT_TRUE(replica.missing().empty());
    const auto build = replica.take_build();
    ASSERT_TRUE(build);
    EXPECT_EQ(build->steps.size(), 3u);
    EXPECT_EQ(build->scene().version(), last.to);
}

TEST_F(SceneReplicaTest, AVersionWhoseBlobsAreHereIsBuiltThoughThoseOfALaterOneAreNot) {
    const auto bytes = [](unsigned char value) { return std::vector<std::byte>(12, std::byte(value)); };
    const scene::Fields<scene::Geometry> shape{&scene::Geometry::positions};
    std::vector<scene::ChangeList> lists;
    for (unsigned char i = 0; i < 3; ++i) {
        scene::Geometry geometry;
        geometry.positions = {blake2b(bytes(i)), 12};
        if (i == 0) {
            lists.push_back(builder.edit({scene::Create{ObjectId{3}, geometry}}));
        } else {
            lists.push_back(builder.edit({test::SceneBuilder::update(ObjectId{3}, shape, geometry)}));
        }
        replica.receive(lists.back());
    }
    blobs->insert(bytes(1));
    ASSERT_TRUE(replica.advance());
    const auto build = replica.take_build();
    ASSERT_TRUE(build);
    EXPECT_EQ(build->scene().version(), lists[1].to);
    EXPECT_EQ(replica.missing(), (std::vector<scene::BlobRef>{{blake2b(bytes(2)), 12}}));
}

// The back-end shares the objects that the replica has checked and does not check the hash of a list again.
TEST_F(SceneReplicaTest, TheBackEndSharesTheObjectsWithoutHashingThemAgain) {
    const auto backend = backend::find_backend("null").make({.blobs = blobs});
    for (std::uint64_t id = 2; id < 300; ++id) replica.receive(camera(id));
    replica.receive(builder.edit(
        {scene::Remove{ObjectId{7}},
         test::SceneBuilder::update(ObjectId{8}, scene::Fields<scene::Camera>(&scene::Camera::name),
                                    scene::Camera{.name = "eight"})}));
    ASSERT_TRUE(replica.advance());
    auto build = replica.take_build();
    ASSERT_TRUE(build);
    const auto scope = backend->begin_edit();
    for (SceneReplica::Step& step : build->steps) {
        step.list.state_hash = {};
        ASSERT_TRUE(scope->apply(step.list, step.after));
    }
    ASSERT_TRUE(scope->commit());
    EXPECT_EQ(scope->scene().state_hash(), builder.scene().state_hash());
    ASSERT_EQ(scope->scene().objects().size(), builder.scene().objects().size());
    for (const auto& [id, object] : replica.scene().objects())
        EXPECT_EQ(scope->scene().find(id), object.get());

    replica.receive(camera(400));  // the replica goes on; the back-end's scene stays
    ASSERT_TRUE(replica.advance());
    EXPECT_EQ(scope->scene().find(ObjectId{400}), nullptr);
}

}  // namespace
}  // namespace tessera::node
