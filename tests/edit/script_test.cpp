#include "tests/edit/fake_target.h"

namespace tessera::edit {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Scripts, AreOneTransaction) {
    FakeTarget target;
    ASSERT_TRUE(
        target.script("# a tour\n\nset lights/bulb.intensity 1\nset lights/bulb.intensity 2\n"
                      "move transforms/left 1 0 0\n"))
        << target.error();
    EXPECT_THAT(target.labels, ElementsAre("set lights/bulb.intensity 1 and 2 more"));
    EXPECT_EQ(target.named<scene::Light>("bulb").intensity, glm::vec3(2.0f));
}

TEST(Scripts, CommitSeparatesTransactions) {
    FakeTarget target;
    ASSERT_TRUE(target.script("set lights/bulb.intensity 1\ncommit\ncommit\nset lights/sun.intensity 2"))
        << target.error();
    EXPECT_THAT(target.labels, ElementsAre("set lights/bulb.intensity 1", "set lights/sun.intensity 2"));
}

TEST(Scripts, EmptyTransactionsAreNotSent) {
    FakeTarget target;
    ASSERT_TRUE(
        target.script("set lights/bulb.intensity 1\nset lights/bulb.intensity 3,2,0.1\n"
                      "create light gone\nremove lights/gone"));
    EXPECT_TRUE(target.labels.empty());
}

TEST(Scripts, MistakeInLine40ChangesNothing) {
    FakeTarget target;
    std::string text;
    for (int line = 1; line < 40; ++line)
        text += line % 10 == 0 ? "commit\n" : "move transforms/left 1 0 0\n";
    const Hash128 before = target.scene().state_hash();
    EXPECT_FALSE(target.script(text + "set lights/bulb.intnsity 1\n"));
    EXPECT_THAT(target.error(), testing::StartsWith("test.txt:40:17: a light has no field 'intnsity'"));
    EXPECT_EQ(target.scene().state_hash(), before);
    EXPECT_TRUE(target.labels.empty()) << "nothing was sent";
    EXPECT_TRUE(target.calls.empty());
    EXPECT_EQ(target.printed(), "");
}

TEST(Scripts, RejectedTransactionUndoesEarlierOnes) {
    FakeTarget target;
    target.refuse_from = 2;
    const Hash128 before = target.scene().state_hash();
    EXPECT_FALSE(
        target.script("set lights/bulb.intensity 1\ncommit\nset lights/sun.intensity 1\ncommit\n"
                      "set lights/spot.intensity 1\ncommit\nmove transforms/left 1 0 0"));
    EXPECT_THAT(target.error(),
                testing::StartsWith("test.txt:5:1: the master rejects it: another client holds it"));
    EXPECT_THAT(target.error(), HasSubstr("transactions undone: 2"));
    EXPECT_EQ(target.scene().state_hash(), before);
    EXPECT_THAT(target.calls, ElementsAre("submit 1", "submit 2", "undo 2", "undo 1"));
}

TEST(Scripts, FailedUndoIsReported) {
    FakeTarget target;
    target.refuse_from = 1;
    target.refuse_undo = true;
    EXPECT_FALSE(target.script("set lights/bulb.intensity 1\ncommit\nset lights/sun.intensity 1"));
    EXPECT_THAT(target.error(),
                HasSubstr("transaction 1 before it could not be undone and remains: it is too old"));
}

TEST(Scripts, ActionsRunInOrderWithEdits) {
    FakeTarget target;
    ASSERT_TRUE(
        target.script("lock lights/bulb\nset lights/bulb.intensity 1\nwait 0.5\nunlock lights/bulb\ncommit\n"
                      "lock lights/sun\nundo\n"))
        << target.error();
    EXPECT_THAT(target.calls,
                ElementsAre("lock 8", "submit 1", "wait 500000000", "unlock 8", "lock 10", "undo 1"));
    EXPECT_EQ(target.printed(), "undone: set lights/bulb.intensity 1\n");
}

TEST(Scripts, SceneCannotBeReadAfterUndo) {
    FakeTarget target;
    ASSERT_TRUE(target.script("set lights/bulb.intensity 1"));
    const Hash128 before = target.scene().state_hash();
    for (const char* line :
         {"set lights/bulb.intensity 2", "show lights/bulb", "list", "save x.glb", "lock lights/bulb"}) {
        EXPECT_FALSE(target.script("undo\n" + std::string(line))) << line;
        EXPECT_THAT(target.error(), HasSubstr("a separate script"));
        EXPECT_THAT(target.error(), HasSubstr("test.txt:2:1: "));
    }
    EXPECT_FALSE(target.script("set lights/bulb.intensity 2\nundo"));
    EXPECT_THAT(target.error(), HasSubstr("uncommitted edits"));
    EXPECT_EQ(target.scene().state_hash(), before);
    EXPECT_TRUE(target.script("undo 1\nwait 0\nlog\nredo")) << target.error();
}

TEST(Scripts, RollbackAndQuit) {
    FakeTarget target;
    const Hash128 before = target.scene().state_hash();
    ASSERT_TRUE(target.script(
        "set lights/bulb.intensity 1\ncreate light new\nremove lights/sun\nremove textures/wood\n"
        "rollback\nshow lights/sun\nquit\nset lights/bulb.intensity 1\nnonsense"))
        << target.error();
    EXPECT_EQ(target.scene().state_hash(), before);
    EXPECT_TRUE(target.labels.empty());
    EXPECT_FALSE(target.script("rollback\nshow lights/new"));
    EXPECT_FALSE(target.script("set lights/bulb.intensity 1\nbegin"));
}

TEST(Scripts, IntermediateStatesMayBeInvalid) {
    FakeTarget target;
    ASSERT_TRUE(target.script("set lights/spot.inner_cone_angle 1\nset lights/spot.outer_cone_angle 1.2"))
        << target.error();
    EXPECT_FALSE(target.script("set lights/spot.outer_cone_angle 0.1\nset lights/bulb.intensity 1\n"));
    EXPECT_THAT(target.error(), HasSubstr("test.txt:1:1: "));
}

TEST(Scripts, LogAndMembersArePrinted) {
    FakeTarget target;
    ASSERT_TRUE(target.script("set lights/bulb.intensity 1\ncommit\nset lights/bulb.intensity 2"));
    ASSERT_TRUE(target.script("log 1"));
    EXPECT_EQ(target.printed(), "2  2023-11-14 22:13:20Z  anna  set lights/bulb.intensity 2\n");
    ASSERT_TRUE(target.script("members"));
    EXPECT_EQ(target.printed(), "anna (editor), editor: paints; holds transforms/left\nwall, viewer\n");
    for (const char* line :
         {"log 0", "log x", "undo 0", "undo -1", "wait -1", "wait x", "wait 1e9", "undo 1 2"}) {
        EXPECT_FALSE(target.script(line)) << line;
    }
}

TEST(Scripts, UnknownCommandsNameTheNearest) {
    FakeTarget target;
    EXPECT_FALSE(target.script("\n  shwo lights/bulb"));
    EXPECT_EQ(target.error(), "test.txt:2:3: there is no command 'shwo'; did you mean 'show'?");
    EXPECT_FALSE(target.script("show"));
    EXPECT_THAT(target.error(), HasSubstr("test.txt:1:5: 'show' needs more arguments: show PATH"));
    EXPECT_FALSE(target.script("show root root"));
    EXPECT_THAT(target.error(), HasSubstr("test.txt:1:11: unexpected argument 'root'"));
}

TEST(Scripts, CloseEndsThem) {
    FakeTarget target;
    ASSERT_TRUE(target.script("close\nset nothing")) << target.error();
    EXPECT_THAT(target.calls, ElementsAre("close"));
    EXPECT_TRUE(target.interpreter().has_quit());
}

}  // namespace
}  // namespace tessera::edit
