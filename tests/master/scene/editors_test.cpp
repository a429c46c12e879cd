#include "master/scene/editors.h"

#include "tests/master/scene/authority_fixture.h"

namespace tessera::master {
namespace {

using namespace scene;

struct EditorsTest : AuthorityFixture {
    Member anna = join(1, "anna"), ben = join(2, "ben");
    ObjectId red = anna.id(0);

    void SetUp() override { must(edit(anna, {Create{red, Material{.name = "red"}}})); }
};

bool says(const EditAnswer& answer, const std::string& text) {
    return !answer.accepted && !answer.problems.empty() && answer.problems[0].find(text) != std::string::npos;
}

TEST_F(EditorsTest, RejectionNamesObjectFieldAndReason) {
    EXPECT_TRUE(says(edit(anna, {roughness(anna.id(7), 0.5f)}),
                     "there is no material " + std::to_string(anna.id(7).value) + ": its roughness"));
    EXPECT_TRUE(says(edit(anna, {set<Light>(red, &Light::intensity, {})}),
                     "('red') is no light: its intensity cannot be set"));
    EXPECT_TRUE(
        says(edit(anna, {roughness(red, 1.5f)}), "('red'): roughness is 1.5: it has to be from 0 to 1"));
    EXPECT_TRUE(says(edit(anna, {Create{ben.id(0), Light{}}}), "outside the id range allocated"));
    EXPECT_TRUE(says(edit(anna, {Create{red, Light{}}}), "exists already"));
    Material textured;
    textured.normal_texture.texture = ObjectId{77};
    EXPECT_TRUE(says(edit(anna, {set<Material>(red, &Material::normal_texture, textured)}),
                     "refers to object 77 as its normal_texture, which is not there"));
}

TEST_F(EditorsTest, RejectedEditHasNoEffect) {
    const Hash128 before = authority.scene().state_hash();
    authority.publish();
    EXPECT_FALSE(
        edit(anna, {roughness(red, 0.5f), Create{anna.id(1), Light{}}, Remove{anna.id(9)}}).accepted);
    EXPECT_FALSE(edit(anna, {roughness(red, 0.5f), metallic(red, 3.0f)}).accepted);
    EXPECT_EQ(authority.scene().state_hash(), before);
    EXPECT_FALSE(authority.has_unpublished());
    EXPECT_TRUE(authority.writers(red).empty());
    EXPECT_EQ(authority.history(10).size(), 1u);
    must(edit(anna, {Create{anna.id(1), Light{}}}));
}

TEST_F(EditorsTest, RecordsTheLastWriterOfEachField) {
    const auto first = must(edit(anna, {roughness(red, 0.5f), metallic(red, 0.5f)}));
    const auto second = must(edit(ben, {metallic(red, 0.25f)}));
    const auto writers = authority.writers(red);
    ASSERT_EQ(writers.size(), 2u) << "the name is as it came";
    EXPECT_EQ(field_bit(writers[0].field), Fields<Material>(&Material::metallic).bits());
    EXPECT_EQ(writers[0].transaction, second);
    EXPECT_EQ(writers[0].name, "ben");
    EXPECT_EQ(writers[0].user, "ben's key");
    EXPECT_EQ(writers[0].time, clock);
    EXPECT_EQ(writers[1].transaction, first);
    must(undo(ben, UndoLatest));
    EXPECT_EQ(authority.writers(red)[0].name, "anna") << "her value is back";
}

TEST_F(EditorsTest, ALockKeepsOthersOut) {
    EXPECT_TRUE(authority.lock(anna.session, "anna", {red}).empty());
    EXPECT_TRUE(says(edit(ben, {roughness(red, 0.5f)}), "is locked by anna"));
    EXPECT_TRUE(says(edit(ben, {Remove{red}}), "is locked by anna"));
    must(edit(anna, {roughness(red, 0.5f)}));
    EXPECT_TRUE(says(undo(ben, authority.transactions()), "is locked by anna"));
    const ObjectId lamp = ben.id(0);
    must(edit(ben, {Create{lamp, Light{}}}));
    EXPECT_FALSE(authority.lock(ben.session, "ben", {lamp, red}).empty());
    EXPECT_EQ(authority.locks().size(), 1u) << "all or none";
    EXPECT_FALSE(authority.lock(ben.session, "ben", {ben.id(5)}).empty()) << "not there";
    authority.unlock(ben.session, {red});
    EXPECT_EQ(authority.locks().size(), 1u) << "not ben's to release";
    authority.forget(anna.session);
    EXPECT_TRUE(authority.locks().empty());
    must(edit(ben, {roughness(red, 0.25f)}));
}

TEST_F(EditorsTest, RemovingAnObjectRemovesItsLock) {
    EXPECT_TRUE(authority.lock(anna.session, "anna", {red}).empty());
    must(edit(anna, {Remove{red}}));
    EXPECT_TRUE(authority.locks().empty());
}

TEST_F(EditorsTest, TheSameKeyIsTheSameEditorWhereverItConnects) {
    const auto change = must(edit(anna, {roughness(red, 0.5f)}));
    authority.forget(anna.session);
    EXPECT_FALSE(edit(anna, {roughness(red, 0.1f)}).accepted);
    const SessionId again{17};
    EXPECT_EQ(authority.join(again, "anna", 1001).first, anna.ids.first);
    EXPECT_EQ(authority.last_sequence(again), 2u);
    anna.session = again;
    anna.sequence = 2;
    must(undo(anna, UndoLatest));
    EXPECT_EQ(authority.history(1)[0].undoes, change);
    EXPECT_NE(authority.join(SessionId{18}, "anna", 1234).first, anna.ids.first) << "another key";
    EXPECT_NE(authority.join(SessionId{19}, "ben", 1001).first, anna.ids.first) << "another user";
}

TEST_F(EditorsTest, LaterConnectionWithTheSameKeyEdits) {
    authority.join(SessionId{17}, "anna", 1001);
    const auto answer = edit(anna, {roughness(red, 0.5f)});
    EXPECT_TRUE(says(answer, "connected elsewhere"));
    authority.forget(anna.session);
    anna.session = SessionId{17};
    anna.sequence = authority.last_sequence(anna.session);
    must(edit(anna, {roughness(red, 0.5f)}));
}

TEST_F(EditorsTest, RepeatsTheLastAnswerAndRejectsOlderOrUnorderedEdits) {
    const auto first = edit(anna, {roughness(red, 0.5f)});
    must(edit(ben, {roughness(red, 0.25f)}));
    anna.sequence -= 1;
    const auto again = edit(anna, {roughness(red, 0.5f)});
    EXPECT_TRUE(again.accepted);
    EXPECT_EQ(again.transaction, first.transaction);
    EXPECT_EQ(again.version, first.version);
    EXPECT_EQ(material(red).roughness, 0.25f) << "not done twice";
    anna.sequence = 0;
    EXPECT_TRUE(says(edit(anna, {roughness(red, 0.5f)}), "older than 2"));
    anna.sequence = 7;
    EXPECT_TRUE(says(edit(anna, {roughness(red, 0.5f)}), "out of order"));
    anna.sequence = 2;
    must(edit(anna, {roughness(red, 0.75f)}));
    // Who joins again says where it goes on: what was refused before is not known for ever.
    authority.forget(anna.session);
    authority.join(anna.session, "anna", 1001);
    anna.sequence = 9;
    must(edit(anna, {roughness(red, 0.5f)}));
}

// By a limit of memory, say.
TEST_F(EditorsTest, AnEditThatWasRefusedBeforehandIsFollowedByTheNext) {
    must(edit(anna, {roughness(red, 0.5f)}));
    authority.refused(anna.session, anna.sequence + 1, "too large");
    const auto repeated = edit(anna, {roughness(red, 0.75f)});
    ASSERT_FALSE(repeated.accepted);
    EXPECT_EQ(repeated.problems.at(0), "too large") << "its answer stays";
    must(edit(anna, {roughness(red, 0.25f)}));
    authority.refused(anna.session, anna.sequence + 5, "there is a gap");
    must(edit(anna, {roughness(red, 0.5f)}));
}

TEST_F(EditorsTest, IdRangesAreAllocatedToOneEditorAtATime) {
    const Scene scene;
    Editors editors;
    std::set<std::uint64_t> allocated;
    for (std::uint64_t i = 1; i <= 4095; ++i) {
        const EditorRecord* editor = editors.join(SessionId{i}, "many", i, scene);
        ASSERT_NE(editor, nullptr) << i;
        EXPECT_TRUE(allocated.insert(editor->ids.first).second);
    }
    EXPECT_EQ(editors.join(SessionId{5000}, "many", 5000, scene), nullptr) << "all are connected";
    editors.leave(SessionId{3});
    EXPECT_EQ(editors.join(SessionId{5000}, "many", 5000, scene), nullptr) << "it may come back";
    for (std::uint64_t i = 1; i <= 1025; ++i) editors.leave(SessionId{i});
    EXPECT_NE(editors.join(SessionId{5000}, "many", 5000, scene), nullptr) << "one was forgotten";
}

TEST_F(EditorsTest, IdsInUseAreNotAllocatedAgain) {
    Scene scene;
    Editors editors;
    const EditorRecord* first = editors.join(SessionId{1}, "", 0, scene);
    ASSERT_TRUE(scene.apply_entries({Create{ObjectId{first->ids.first + 5}, Light{}}}));
    editors.leave(SessionId{1});
    for (std::uint64_t i = 2; i < 1000; ++i) {
        const EditorRecord* editor = editors.join(SessionId{i}, "", 0, scene);
        ASSERT_NE(editor, nullptr);
        ASSERT_FALSE(editor->ids.contains(scene.objects().begin()->first));
        editors.leave(SessionId{i});
    }
}

// What cannot be recorded does not happen.
TEST_F(EditorsTest, UnrecordedEditIsReverted) {
    struct FullDisk final : EditRecorder {
        Expected<void> joined(const wire::RecordedEditor&) override {
            return failure(ErrorCode::Io, "the disk is full");
        }
        Expected<void> edited(const RecordedEdit& edit) override {
            last = edit;
            return full ? joined({}) : Expected<void>();
        }
        void cleared() override { ++clears; }
        bool full = true;
        int clears = 0;
        RecordedEdit last;
    } disk;
    authority.publish();
    authority.record_to(&disk);
    const Hash128 before = authority.scene().state_hash();
    EXPECT_TRUE(says(edit(anna, {Create{anna.id(1), Light{}}, root_children({anna.id(1)})}), "disk is full"));
    EXPECT_TRUE(says(undo(anna, UndoLatest), "disk is full"));
    EXPECT_EQ(authority.join(SessionId{9}, "carl", 9).count, 0u);
    EXPECT_EQ(authority.scene().state_hash(), before);
    EXPECT_FALSE(authority.has_unpublished());
    EXPECT_EQ(authority.history(9).size(), 1u);
    EXPECT_FALSE(authority.follow_camera({1e6, 0, 0}));
    disk.full = false;
    const auto number = must(edit(anna, {roughness(red, 0.5f)}));
    EXPECT_EQ(disk.last.transaction, number);
    EXPECT_EQ(disk.last.state_hash, authority.scene().state_hash());
    EXPECT_EQ(disk.last.text, "set materials/red roughness");
    must(undo(anna, UndoLatest));
    EXPECT_EQ(disk.last.undo, number) << "not 'the latest': what that is depends on the time";
    EXPECT_EQ(disk.last.entries.size(), 1u);
    EXPECT_TRUE(authority.clear());
    EXPECT_EQ(disk.clears, 1);
}

}  // namespace
}  // namespace tessera::master
