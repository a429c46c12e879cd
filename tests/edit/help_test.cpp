#include "client/edit/help.h"

#include "client/edit/commands.h"
#include "client/edit/path_index.h"
#include "client/edit/values.h"
#include "tests/edit/fake_target.h"

namespace tessera::edit {
namespace {

using testing::HasSubstr;

TEST(Help, HasEveryCommandAndField) {
    const std::string overview = help_text(""), manual = whole_manual();
    for (const Command& command : commands()) {
        EXPECT_THAT(overview, HasSubstr(std::string(command.usage)));
        EXPECT_THAT(help_text(command.name), testing::StartsWith(std::string(command.usage) + "\n"));
        EXPECT_THAT(manual, HasSubstr(help_text(command.name)));
        EXPECT_TRUE(command.usage.starts_with(command.name));
        EXPECT_TRUE(command.max_arguments == 0 || !command.arguments.empty())
            << command.name << " completes nothing";
    }
    for (const scene::KindRow& row : scene::Kinds) {
        const std::string text = help_text(row.plural);
        EXPECT_THAT(manual, HasSubstr(text));
        for (const std::string& field : field_names(row.kind))
            EXPECT_THAT(text, HasSubstr("  " + field + " "));
    }
    for (const std::string& topic : help_topics()) EXPECT_NE(help_text(topic), "") << topic;
}

TEST(Help, LinesFitATerminal) {
    const std::string manual = whole_manual();
    for (std::size_t at = 0; at < manual.size();) {
        const std::size_t end = std::min(manual.find('\n', at), manual.size());
        EXPECT_LE(end - at, 120u) << manual.substr(at, end - at);
        at = end + 1;
    }
}

TEST(Help, IsACommand) {
    FakeTarget target;
    ASSERT_TRUE(target.script("help set"));
    EXPECT_EQ(target.printed(), help_text("set"));
    EXPECT_FALSE(target.script("help sett"));
    EXPECT_THAT(target.error(),
                HasSubstr("test.txt:1:6: there is no help topic 'sett'; did you mean 'set'?"));
}

}  // namespace
}  // namespace tessera::edit
