#include "master/scene/scene_authority.h"

#include <gtest/gtest.h>

#include "mediator/scene/fields.h"

namespace tessera::master {
namespace {

using namespace scene;

struct SceneAuthorityTest : testing::Test {
    std::shared_ptr<BlobStore> blobs = std::make_shared<BlobStore>();
    SceneAuthority authority{42, blobs};
    SessionId session{1};
    SceneAuthority::IdRange ids = authority.allocate_id_range(session);
    std::uint64_t sequence = 0;

    SceneAuthority::Answer submit(std::vector<Entry> entries) {
        return authority.submit({.session = session,
                                 .sequence = ++sequence,
                                 .base = authority.version(),
                                 .entries = std::move(entries)});
    }
    ObjectId id(std::uint64_t i) const { return ObjectId{ids.first + i}; }
};

TEST_F(SceneAuthorityTest, NumbersVersionsAndMakesChangeListsForReplicas) {
    Scene replica;
    ASSERT_TRUE(replica.apply(authority.published().snapshot()));
    const auto created = submit({Create{id(0), Light{.name = "sun"}}});
    ASSERT_TRUE(created.accepted) << created.problems.at(0);
    EXPECT_EQ(created.version, (Version{42, 2}));
    const auto changes = authority.publish();
    ASSERT_TRUE(changes);
    EXPECT_EQ(changes->to, created.version);
    EXPECT_TRUE(replica.apply(*changes));
    EXPECT_EQ(replica.state_hash(), authority.scene().state_hash());
}

TEST_F(SceneAuthorityTest, AResentEditIsHarmless) {
    const Edit edit{
        .session = session, .sequence = 1, .base = authority.version(), .entries = {Create{id(0), Light{}}}};
    const auto first = authority.submit(edit), again = authority.submit(edit);
    EXPECT_TRUE(again.accepted);
    EXPECT_EQ(again.version, first.version);
    EXPECT_TRUE(authority.publish());
    EXPECT_FALSE(authority.publish());
    EXPECT_EQ(authority.version().number, 2u);
}

TEST_F(SceneAuthorityTest, RejectsInvalidEditsAndKeepsTheScene) {
    const Version before = authority.version();
    EXPECT_FALSE(submit({Create{ObjectId{7}, Light{}}}).accepted) << "an id outside the allocated range";
    EXPECT_FALSE(submit({Remove{RootId}}).accepted);
    EXPECT_FALSE(submit({Remove{id(3)}}).accepted) << "an object that is not there";
    Transform broken;
    broken.matrix[3][0] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(submit({Create{id(0), Light{}}, Create{id(1), broken}}).accepted) << "not a number";
    Transform dangling;
    dangling.children = {id(99)};
    EXPECT_FALSE(submit({Create{id(1), dangling}}).accepted);
    EXPECT_EQ(authority.version(), before);
    EXPECT_EQ(authority.scene().objects().size(), 1u);
}

// What no back-end can flatten has to be refused here: a node cannot send an edit back.
TEST_F(SceneAuthorityTest, RefusesAGraphThatBackEndsCannotHoldAndKeepsTheScene) {
    const auto chain = [&](std::uint64_t depth) {
        std::vector<Entry> entries{Create{id(0), Light{}}};
        for (std::uint64_t i = 1; i <= depth; ++i) {
            Transform link;
            link.children = {id(i - 1)};
            entries.push_back(Create{id(i), link});
        }
        Root root;
        root.children = {id(depth)};
        entries.push_back(Update{RootId, Fields<Root>(&Root::children).bits(), root});
        return entries;
    };
    const Hash128 before = authority.scene().state_hash();
    const auto too_deep = submit(chain(MaxDepth + 1));
    EXPECT_FALSE(too_deep.accepted);
    EXPECT_NE(too_deep.problems.at(0).find("nested deeper than 1024"), std::string::npos);
    EXPECT_EQ(authority.scene().state_hash(), before);
    EXPECT_TRUE(submit(chain(MaxDepth)).accepted);

    // 24 levels of two transforms each that share both of the next level: 2^24 lights.
    std::vector<Entry> doubling;
    const std::uint64_t first = MaxDepth + 1;
    for (std::uint64_t level = 0; level < 24; ++level) {
        for (std::uint64_t side = 0; side < 2; ++side) {
            Transform link;
            link.children = level == 0 ? std::vector{id(0)}
                                       : std::vector{id(first + 2 * level - 2), id(first + 2 * level - 1)};
            doubling.push_back(Create{id(first + 2 * level + side), link});
        }
    }
    Root root;
    root.children = {id(first + 46), id(first + 47)};
    doubling.push_back(Update{RootId, Fields<Root>(&Root::children).bits(), root});
    const auto too_many = submit(doubling);
    EXPECT_FALSE(too_many.accepted);
    EXPECT_NE(too_many.problems.at(0).find("16000000 instances"), std::string::npos);
}

TEST_F(SceneAuthorityTest, RefusesABlobOfAnotherSizeThanItsReferenceSays) {
    const BlobPtr blob = blobs->insert(std::as_bytes(std::span("123456789012", 12)));
    Geometry geometry;
    geometry.positions = {blob->hash(), 24};
    const auto wrong = submit({Create{id(0), geometry}});
    EXPECT_FALSE(wrong.accepted);
    EXPECT_NE(wrong.problems.at(0).find("12 bytes, not 24"), std::string::npos) << wrong.problems.at(0);
    geometry.positions.byte_size = 12;
    geometry.indices = geometry.positions;
    const auto right = submit({Create{id(0), geometry}});
    EXPECT_TRUE(right.accepted) << right.problems.at(0);
}

TEST_F(SceneAuthorityTest, ClearRestoresTheInitialState) {
    const Hash128 empty = authority.scene().state_hash();
    blobs->insert(std::as_bytes(std::span("a blob that only the scene needed")));
    Root root;
    root.children = {id(0)};
    ASSERT_TRUE(
        submit({Create{id(0), Transform{}}, Update{RootId, Fields<Root>(&Root::children).bits(), root}})
            .accepted);
    const auto cleared = authority.clear();
    ASSERT_TRUE(cleared);
    EXPECT_EQ(authority.scene().state_hash(), empty);
    EXPECT_EQ(blobs->count(), 0u);
    EXPECT_FALSE(authority.clear());
    EXPECT_EQ(authority.allocate_id_range(SessionId{99}).first, ids.first)
        << "the next batch gets the same ids, so the same bits";
}

TEST_F(SceneAuthorityTest, TheRenderOriginMovesInCoarseStepsOnly) {
    EXPECT_FALSE(authority.follow_camera({10, 20, -200}));
    const auto moved = authority.follow_camera({1e6 + 3, 0, 0});
    ASSERT_TRUE(moved);
    const auto origin = authority.scene().find_as<Root>(RootId)->render_origin;
    EXPECT_LE(std::abs(origin.x - (1e6 + 3)), RenderOriginCell / 2);
    EXPECT_EQ(std::fmod(origin.x, RenderOriginCell), 0.0);
    EXPECT_FALSE(authority.follow_camera({1e6 + 100, 0, 0})) << "still near";
}

}  // namespace
}  // namespace tessera::master
