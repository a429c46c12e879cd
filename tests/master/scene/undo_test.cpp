#include "master/scene/undo_plan.h"
#include "tests/master/scene/authority_fixture.h"

namespace tessera::master {
namespace {

using namespace scene;

struct UndoTest : AuthorityFixture {
    Member anna = join(1, "anna"), ben = join(2, "ben");
    ObjectId red = anna.id(0);

    void SetUp() override { must(edit(anna, {Create{red, Material{.name = "red"}}})); }
};

bool names(const std::vector<std::string>& notes, const std::string& a, const std::string& b) {
    return std::any_of(notes.begin(), notes.end(), [&](const std::string& note) {
        return note.find(a) != std::string::npos && note.find(b) != std::string::npos;
    });
}

TEST_F(UndoTest, RestoresFieldsThatNoOtherEditorWroteSince) {
    const auto first = must(edit(anna, {roughness(red, 0.2f), metallic(red, 0.3f)}));
    must(edit(ben, {roughness(red, 0.7f)}));
    const auto answer = undo(anna, first);
    must(answer);
    EXPECT_EQ(material(red).roughness, 0.7f) << "ben's";
    EXPECT_EQ(material(red).metallic, 0.0f);
    EXPECT_TRUE(names(answer.notes, "materials/red roughness", "ben")) << answer.notes.size();
}

TEST_F(UndoTest, ADragIsOneTransaction) {
    const Hash128 before = authority.scene().state_hash();
    const auto first = must(edit(anna, {roughness(red, 0.1f)}, 5));
    must(edit(ben, {metallic(red, 0.9f)}));
    EXPECT_EQ(must(edit(anna, {roughness(red, 0.2f)}, 5)), first) << "others may come in between";
    EXPECT_EQ(must(edit(anna, {roughness(red, 0.3f), metallic(red, 0.4f)}, 5)), first);
    EXPECT_EQ(authority.history(10).at(1).edits, 3u);
    EXPECT_EQ(authority.history(10).at(1).text, "set materials/red metallic, roughness");
    must(undo(anna, first));
    EXPECT_EQ(material(red).roughness, 1.0f);
    EXPECT_EQ(material(red).metallic, 0.9f) << "as it was before anna's first write of that field";
    must(undo(ben, UndoLatest));
    EXPECT_EQ(authority.scene().state_hash(), before);
    EXPECT_NE(must(edit(anna, {roughness(red, 0.5f)}, 5)), first) << "not in a row any more";
}

TEST_F(UndoTest, OtherEditGroupsAndOtherSessionsAreOtherTransactions) {
    const auto first = must(edit(anna, {roughness(red, 0.1f)}, 5));
    EXPECT_NE(must(edit(ben, {roughness(red, 0.2f)}, 5)), first);
    EXPECT_NE(must(edit(anna, {roughness(red, 0.3f)}, 6)), first);
    const auto alone = must(edit(anna, {roughness(red, 0.4f)}));
    EXPECT_NE(must(edit(anna, {roughness(red, 0.5f)})), alone) << "0 is no edit group";
}

TEST_F(UndoTest, RemovedObjectIsRestoredWithIdPositionAndReferences) {
    const ObjectId a = anna.id(1), b = anna.id(2), c = anna.id(3), wall = anna.id(4), d = ben.id(0);
    Geometry geometry{.indices = {Hash256{}, 12}, .positions = {Hash256{}, 36}};
    geometry.material = red;
    must(edit(anna, {Create{a, Light{}}, Create{b, Light{}}, Create{c, Light{}}, Create{wall, geometry},
                     root_children({a, b, c, wall})}));
    must(edit(anna, {roughness(red, 0.5f)}));
    geometry.material = {};
    const auto removal = must(edit(anna, {Remove{b}, Remove{red}, root_children({a, c, wall}),
                                          set<Geometry>(wall, &Geometry::material, geometry)}));
    EXPECT_TRUE(authority.writers(red).empty()) << "gone with the object";
    must(edit(ben, {Create{d, Light{}}, root_children({d, c, a, wall})}));
    must(undo(anna, removal));
    EXPECT_EQ(root_children(), (std::vector{d, c, a, b, wall})) << "b follows a, what ben did stays";
    EXPECT_EQ(authority.scene().find_as<Geometry>(wall)->material, red);
    EXPECT_EQ(material(red).roughness, 0.5f);
    ASSERT_EQ(authority.writers(red).size(), 1u);
    EXPECT_EQ(authority.writers(red)[0].name, "anna");
}

TEST_F(UndoTest, AddedChildIsRemovedFromAListThatOthersChanged) {
    const ObjectId a = anna.id(1), b = ben.id(1);
    const auto added = must(edit(anna, {Create{a, Light{}}, root_children({a})}));
    must(edit(ben, {Create{b, Light{}}, root_children({b, a})}));
    must(undo(anna, added));
    EXPECT_EQ(root_children(), std::vector{b});
    EXPECT_EQ(authority.scene().find(a), nullptr);
    must(undo(anna, RedoLatest));
    EXPECT_EQ(root_children(), (std::vector{b, a}));
}

TEST_F(UndoTest, UndoOfACreateIsRejectedWhileReferenced) {
    Geometry geometry{.indices = {Hash256{}, 12}, .positions = {Hash256{}, 36}};
    geometry.material = red;
    must(edit(ben, {Create{ben.id(0), geometry}}));
    const Hash128 before = authority.scene().state_hash();
    const auto answer = undo(anna, UndoLatest);
    EXPECT_FALSE(answer.accepted);
    EXPECT_TRUE(names(answer.problems, "geometry", "refers to")) << answer.problems.at(0);
    EXPECT_EQ(authority.scene().state_hash(), before);
    must(undo(ben, UndoLatest));
    must(undo(anna, UndoLatest));
    EXPECT_EQ(authority.scene().objects().size(), 1u);
}

TEST_F(UndoTest, UndoesAndRedoesOwnTransactions) {
    must(edit(anna, {roughness(red, 0.1f)}));
    must(edit(anna, {roughness(red, 0.2f)}));
    must(edit(ben, {metallic(red, 0.5f)}));
    must(undo(anna, UndoLatest));
    EXPECT_EQ(material(red).roughness, 0.1f);
    must(undo(anna, UndoLatest));
    EXPECT_EQ(material(red).roughness, 1.0f);
    must(undo(anna, RedoLatest));
    EXPECT_EQ(material(red).roughness, 0.1f);
    must(undo(anna, RedoLatest));
    EXPECT_EQ(material(red).roughness, 0.2f);
    EXPECT_FALSE(undo(anna, RedoLatest).accepted) << "nothing left";
    EXPECT_EQ(authority.history(1)[0].text, "redid 3: set materials/red roughness");
    must(undo(anna, UndoLatest));
    EXPECT_EQ(material(red).roughness, 0.1f) << "what was redone can be undone again";
    EXPECT_EQ(material(red).metallic, 0.5f) << "ben's all the time";
}

TEST_F(UndoTest, ReportsWhoUndidWhatAndRejectsRepeatedUndo) {
    const auto first = must(edit(anna, {roughness(red, 0.1f)}));
    const auto taken_back = must(undo(ben, first));
    const auto list = authority.history(2);
    EXPECT_EQ(list[0].undoes, first);
    EXPECT_EQ(list[0].name, "ben");
    EXPECT_EQ(list[1].undone_by, taken_back);
    EXPECT_FALSE(undo(anna, first).accepted);
    EXPECT_FALSE(undo(anna, 4711).accepted) << "never was";
    must(undo(ben, taken_back));
    EXPECT_EQ(material(red).roughness, 0.1f);
    EXPECT_EQ(authority.history(3)[2].undone_by, 0u) << "in force again";
}

TEST_F(UndoTest, ReportsObjectsRemovedMeanwhile) {
    const auto first = must(edit(anna, {roughness(red, 0.1f)}));
    must(edit(ben, {Remove{red}}));
    const auto answer = undo(anna, first);
    must(answer);
    EXPECT_TRUE(names(answer.notes, "materials/red", "ben"));
    EXPECT_EQ(authority.scene().find(red), nullptr);
}

TEST_F(UndoTest, ReachesBack256Transactions) {
    const auto first = must(edit(anna, {roughness(red, 0.5f)}));
    for (int i = 1; i < 256; ++i) must(edit(anna, {metallic(red, static_cast<float>(i) / 256.0f)}));
    EXPECT_EQ(authority.history(1000).size(), 256u);
    EXPECT_EQ(authority.history(1000).back().number, first);
    must(undo(anna, first));
    EXPECT_EQ(material(red).roughness, 1.0f);
    EXPECT_FALSE(undo(anna, first - 1).accepted) << "the one before is forgotten";
}

TEST_F(UndoTest, AnObjectCreatedAndRemovedInOneEditGroupLeavesNothing) {
    const Hash128 before = authority.scene().state_hash();
    const ObjectId a = anna.id(1);
    const auto made = must(edit(anna, {Create{a, Light{}}, root_children({a})}, 9));
    EXPECT_EQ(must(edit(anna, {Remove{a}, root_children({})}, 9)), made);
    EXPECT_EQ(authority.scene().state_hash(), before);
    must(undo(anna, made));
    EXPECT_EQ(authority.scene().state_hash(), before);
}

TEST(WithoutStep, MergesListsOfChildren) {
    const auto ids = [](std::initializer_list<std::uint64_t> list) {
        std::vector<ObjectId> result;
        for (const std::uint64_t id : list) result.push_back({id});
        return result;
    };
    EXPECT_EQ(without_change(ids({1, 2, 3}), ids({1, 3}), ids({9, 1, 3})), ids({9, 1, 2, 3}));
    EXPECT_EQ(without_change(ids({1, 2, 3}), ids({2, 3}), ids({3, 2})), ids({1, 3, 2})) << "at the front";
    EXPECT_EQ(without_change(ids({1, 2, 3}), ids({}), ids({7})), ids({1, 2, 3, 7}));
    EXPECT_EQ(without_change(ids({1}), ids({1, 1}), ids({1, 5, 1})), ids({1, 5})) << "one of two instances";
    EXPECT_EQ(without_change(ids({1}), ids({1, 2}), ids({1})), ids({1})) << "gone already";
    EXPECT_EQ(without_change(ids({1, 1}), ids({1}), ids({1, 4})), ids({1, 1, 4}));
}

}  // namespace
}  // namespace tessera::master
