#include "tests/edit/fake_target.h"

namespace tessera::edit {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(PromptLines, AreSeparateTransactions) {
    FakeTarget target;
    ASSERT_TRUE(target.line("set lights/bulb.intensity 1"));
    ASSERT_TRUE(target.line(""));
    ASSERT_TRUE(target.line("  # nothing"));
    ASSERT_TRUE(target.line("set lights/bulb.intensity 2"));
    EXPECT_THAT(target.labels, ElementsAre("set lights/bulb.intensity 1", "set lights/bulb.intensity 2"));
    ASSERT_TRUE(target.line("undo"));
    EXPECT_EQ(target.printed(), "undone: set lights/bulb.intensity 2\n");
    ASSERT_TRUE(target.line("show lights/bulb")) << "behind an undo the scene is known again";
    EXPECT_THAT(target.printed(), HasSubstr("1 1 1"));
}

TEST(PromptLines, BeginDefersThemUntilCommit) {
    FakeTarget target;
    ASSERT_TRUE(target.line("begin"));
    EXPECT_TRUE(target.interpreter().is_in_transaction());
    ASSERT_TRUE(target.line("create light new"));
    EXPECT_TRUE(target.labels.empty());
    ASSERT_TRUE(target.line("show lights/new"));
    EXPECT_THAT(target.printed(), HasSubstr("# not committed"));
    EXPECT_TRUE(target.calls.empty()) << "the master cannot know it";
    EXPECT_FALSE(target.line("set lights/new.nothing 1"));
    EXPECT_EQ(target.error().substr(0, 11), "column 16: ");
    EXPECT_FALSE(target.line("undo"));
    EXPECT_FALSE(target.line("begin"));
    ASSERT_TRUE(target.line("set lights/new.intensity 7")) << "the transaction goes on";
    ASSERT_TRUE(target.line("commit")) << target.error();
    EXPECT_FALSE(target.interpreter().is_in_transaction());
    EXPECT_EQ(target.named<scene::Light>("new").intensity, glm::vec3(7.0f));
    EXPECT_EQ(target.labels.size(), 1u);
}

TEST(PromptLines, RollbackDiscardsThem) {
    FakeTarget target;
    const Hash128 before = target.scene().state_hash();
    ASSERT_TRUE(target.line("begin"));
    ASSERT_TRUE(target.line("remove lights/sun"));
    ASSERT_TRUE(target.line("rollback"));
    ASSERT_TRUE(target.line("show lights/sun")) << target.error();
    EXPECT_EQ(target.scene().state_hash(), before);
}

TEST(PromptLines, RejectedCommitKeepsTheTransaction) {
    FakeTarget target;
    ASSERT_TRUE(target.line("begin"));
    ASSERT_TRUE(target.line("create light new"));
    target.refuse_from = 0;
    EXPECT_FALSE(target.line("commit"));
    EXPECT_THAT(target.error(), HasSubstr("another client holds it"));
    EXPECT_TRUE(target.interpreter().is_in_transaction());
    target.refuse_from = ~std::size_t{0};
    ASSERT_TRUE(target.line("commit")) << target.error();
    target.named<scene::Light>("new");
}

TEST(PromptLines, SeeEditsOfOthers) {
    FakeTarget target;
    ASSERT_TRUE(target.line("list lights"));
    ASSERT_TRUE(target.script("create light theirs"));
    ASSERT_TRUE(target.line("set lights/theirs.intensity 2")) << target.error();
}

}  // namespace
}  // namespace tessera::edit
