// Edit commands of version 0.1 still work, with a hint.
#include <gmock/gmock.h>

#include "tests/edit/fake_target.h"

namespace tessera::edit {
namespace {

TEST(OldNames, CommandsWorkWithAHint) {
    FakeTarget target;
    ASSERT_TRUE(target.script("members"));
    const std::string members = target.printed();
    ASSERT_TRUE(target.script("people"));
    const std::string printed = target.printed();
    EXPECT_THAT(printed, testing::HasSubstr("'people' is now 'members'"));
    EXPECT_THAT(printed, testing::HasSubstr(members));
}

}  // namespace
}  // namespace tessera::edit
