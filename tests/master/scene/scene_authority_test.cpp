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
    ASSERT_TRUE(replica.apply(authority.snapshot()));
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
