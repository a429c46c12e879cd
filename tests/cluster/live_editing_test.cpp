// Several members of one live scene: edits are visible to the others, errors only to their sender.
#include <gtest/gtest.h>

#include "mediator/scene/fields.h"
#include "tests/cluster/cluster_scene.h"
#include "tests/cluster/loopback_cluster.h"

namespace tessera::test {
namespace {

using namespace scene;
using namespace std::chrono_literals;

struct LiveEditing : testing::Test {
    LoopbackCluster cluster;
    std::shared_ptr<BlobStore> ann_blobs = std::make_shared<BlobStore>(),
                               bob_blobs = std::make_shared<BlobStore>();
    std::unique_ptr<client::Session> ann = cluster.member("ann", ann_blobs),
                                     bob = cluster.member("bob", bob_blobs);
    ObjectId first;

    void SetUp() override {
        first = ann->new_id();
        for (int i = 0; i < 3; ++i) ann->new_id();
        const auto result = ann->submit(scene_entries(first, *ann_blobs));
        ASSERT_TRUE(result.accepted) << result.problems.at(0);
    }
    ObjectId material() const { return ObjectId{first.value + 1}; }
    Update paint(glm::vec4 color) const {
        return {material(), Fields<Material>(&Material::base_color).bits(), Material{.base_color = color}};
    }
    static glm::vec4 color(client::Session& of, ObjectId id) {
        of.refresh();
        return of.scene().find_as<Material>(id)->base_color;
    }
};

TEST_F(LiveEditing, EditsAreVisibleToOtherMembers) {
    bob->refresh();
    ann->refresh();
    EXPECT_EQ(bob->scene().state_hash(), ann->scene().state_hash());
    const auto result = bob->submit({paint({1, 0, 0, 1})});
    ASSERT_TRUE(result.accepted);
    EXPECT_NE(result.transaction, 0u);
    EXPECT_EQ(color(*ann, material()), glm::vec4(1, 0, 0, 1));
    const Geometry* geometry = ann->scene().find_as<Geometry>(ObjectId{first.value + 2});
    ASSERT_NE(geometry, nullptr);
    EXPECT_EQ(bob->fetch(geometry->positions)->bytes().size(), 36u) << "arrays can be read back";
}

TEST_F(LiveEditing, ALongEditAndALongSceneTravelAsBlobs) {
    std::vector<Entry> many;
    for (int i = 0; i < 3000; ++i) {
        many.push_back(Create{ann->new_id(), Material{.name = "material number " + std::to_string(i)}});
    }
    ASSERT_TRUE(ann->submit(std::move(many)).accepted);
    bob->refresh();
    EXPECT_EQ(bob->scene().objects().size(), 3000u + 5u);
}

TEST_F(LiveEditing, ARefusedEditChangesNothing) {
    bob->refresh();
    const Version before = bob->scene().version();
    Transform dangling;
    dangling.children = {ObjectId{999}};
    const auto result = ann->submit(
        {paint({0, 1, 0, 1}), Update{first, Fields<Transform>(&Transform::children).bits(), dangling}});
    EXPECT_FALSE(result.accepted);
    ASSERT_FALSE(result.problems.empty());
    EXPECT_NE(result.problems[0].find("999"), std::string::npos) << result.problems[0];
    bob->refresh();
    EXPECT_EQ(bob->scene().version(), before);
}

TEST_F(LiveEditing, AViewerSeesCamerasButNeitherReadsNorEditsTheScene) {
    auto blobs = std::make_shared<BlobStore>();
    const auto eve = cluster.member("eve", blobs, net::Role::Viewer);
    for (const auto& [id, object] : eve->scene().objects()) {
        const ObjectKind kind = scene::kind(*object);
        EXPECT_TRUE(kind == ObjectKind::Root || kind == ObjectKind::Transform || kind == ObjectKind::Camera)
            << id.value;
    }
    eve->refresh();
    bob->refresh();
    EXPECT_EQ(eve->scene().version(), bob->scene().version());
    for (const auto& [id, object] : bob->scene().objects()) {
        const auto* geometry = std::get_if<scene::Geometry>(object.get());
        if (geometry == nullptr) continue;
        EXPECT_THROW((void)eve->fetch(geometry->positions), Error) << "blobs are for editors";
        EXPECT_NE(bob->fetch(geometry->positions), nullptr);
    }
    EXPECT_THROW((void)eve->history(10), Error);
    EXPECT_THROW((void)eve->writers(material()), Error);
    try {
        (void)eve->submit({paint({0, 0, 0, 1})});
        FAIL() << "a viewer edited the scene";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::Refused);
        EXPECT_NE(std::string(error.what()).find("viewer"), std::string::npos) << error.what();
    }
    EXPECT_NE(color(*bob, material()), glm::vec4(0, 0, 0, 1));
}

TEST_F(LiveEditing, NamesAreMadeUnique) {
    auto blobs = std::make_shared<BlobStore>();
    const auto other_ann = cluster.member("ann", blobs);
    std::vector<std::string> names;
    for (const session::Member& member : bob->members().members) names.push_back(member.name);
    EXPECT_EQ(names, (std::vector<std::string>{"ann", "bob", "ann (2)"}));
}

TEST_F(LiveEditing, UndoRevertsOwnChangesAndReportsTheOthers) {
    ASSERT_TRUE(ann->submit({paint({1, 0, 0, 1})}).accepted);
    ASSERT_TRUE(ann->undo().accepted);
    EXPECT_EQ(color(*bob, material()), Material{}.base_color);
    ASSERT_TRUE(ann->redo().accepted);
    EXPECT_EQ(color(*bob, material()), glm::vec4(1, 0, 0, 1));
    const auto mine = ann->submit({paint({0, 1, 0, 1})});
    ASSERT_TRUE(bob->submit({paint({0, 0, 1, 1})}).accepted);
    const auto undone = ann->undo(mine.transaction);
    EXPECT_EQ(color(*bob, material()), glm::vec4(0, 0, 1, 1)) << "bob wrote last";
    std::string notes;
    for (const std::string& note : undone.notes) notes += note;
    for (const std::string& problem : undone.problems) notes += problem;
    EXPECT_NE(notes.find("bob"), std::string::npos) << notes;
}

TEST_F(LiveEditing, ADragIsOneTransaction) {
    const std::size_t before = ann->history(256).size();
    for (int i = 1; i <= 50; ++i) ann->submit_ahead({paint({0.01f * float(i), 0, 0, 1})}, 7);
    ann->settle();
    const auto history = ann->history(256);
    ASSERT_EQ(history.size(), before + 1);
    EXPECT_EQ(history[0].edits, 50u);
    EXPECT_EQ(history[0].name, "ann");
    ASSERT_TRUE(ann->undo().accepted);
    EXPECT_EQ(color(*bob, material()), Material{}.base_color);
}

TEST_F(LiveEditing, ALockedObjectCanOnlyBeEditedByItsHolder) {
    ann->lock({material()});
    const auto refused = bob->submit({paint({0, 0, 0, 1})});
    EXPECT_FALSE(refused.accepted);
    ASSERT_FALSE(refused.problems.empty());
    EXPECT_NE(refused.problems[0].find("ann"), std::string::npos) << refused.problems[0];
    EXPECT_THROW(bob->lock({material()}), Error);
    EXPECT_TRUE(ann->submit({paint({1, 0, 0, 1})}).accepted);
    ann.reset();  // locks go with their holder
    const auto deadline = std::chrono::steady_clock::now() + 30s;
    while (bob->members().members.size() > 1 && std::chrono::steady_clock::now() < deadline) {
    }
    EXPECT_TRUE(bob->submit({paint({0, 0, 0, 1})}).accepted);
}

TEST_F(LiveEditing, PresenceExpires) {
    ann->set_presence("looks at the lamp", {material()}, 10min);
    bob->set_presence("here for a moment", {}, 1ms);
    (void)ann->members();
    const auto deadline = std::chrono::steady_clock::now() + 30s;
    while (std::chrono::steady_clock::now() < deadline) {
        const session::Members members = bob->members();
        if (members.members.at(1).text.empty() && !members.members.at(0).text.empty()) {
            EXPECT_EQ(members.members[0].selection, std::vector<ObjectId>{material()});
            return;
        }
    }
    FAIL() << "presence was not seen, or did not end";
}

TEST_F(LiveEditing, TheWriterOfAFieldIsKnown) {
    const auto result = bob->submit({paint({1, 0, 0, 1})});
    const auto writers = ann->writers(material());
    ASSERT_EQ(writers.size(), 1u);
    EXPECT_EQ(field_bit(writers[0].field), Fields<Material>(&Material::base_color).bits());
    EXPECT_EQ(writers[0].name, "bob");
    EXPECT_EQ(writers[0].transaction, result.transaction);
}

TEST_F(LiveEditing, AfterTheSceneIsClosedABatchMayOpenOne) {
    cluster.add_node("null");
    ann->close_scene();
    auto blobs = std::make_shared<BlobStore>();
    const auto batch = cluster.session(blobs);
    const auto opened =
        batch->join({.title = "batch", .exclusive = true, .when_busy = client::WhenBusy::GiveUp}, {});
    EXPECT_TRUE(std::holds_alternative<client::Joined>(opened));
    EXPECT_THROW((void)bob->members(), Error) << "bob is no longer in a scene";
}

TEST_F(LiveEditing, ABatchCannotJoinWhileALiveSceneIsOpen) {
    auto blobs = std::make_shared<BlobStore>();
    const auto batch = cluster.session(blobs);
    const auto outcome =
        batch->join({.title = "batch", .exclusive = true, .when_busy = client::WhenBusy::GiveUp}, {});
    ASSERT_TRUE(std::holds_alternative<client::Busy>(outcome));
    EXPECT_NE(std::get<client::Busy>(outcome).reason.find("live scene"), std::string::npos);
}

}  // namespace
}  // namespace tessera::test
