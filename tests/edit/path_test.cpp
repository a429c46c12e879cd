#include "tests/edit/fake_target.h"

namespace tessera::edit {
namespace {

using testing::HasSubstr;

TEST(Paths, ShortAndFullPathsAreEquivalent) {
    FakeTarget target;
    const std::string id = std::to_string(target.id_of("wood").value);
    EXPECT_TRUE(target.script("set textures/wood.name a\n")) << target.error();
    EXPECT_TRUE(target.script("set textures/a@" + id + ".name b\n")) << target.error();
    EXPECT_TRUE(target.script("set texture/whatever@" + id + ".name c\n"))
        << "the id decides: " << target.error();
    EXPECT_TRUE(target.script("set textures/@" + id + ".name wood\n")) << target.error();
    target.named<scene::Texture>("wood");
}

TEST(Paths, ArePrintedShortWhereTheyAreUnique) {
    FakeTarget target;
    ASSERT_TRUE(target.script("list"));
    EXPECT_THAT(target.printed(), HasSubstr("transforms/wheel\n"));
    EXPECT_THAT(target.printed(), HasSubstr("materials/\"my \\\"red\\\"\"\n"));
    EXPECT_THAT(target.printed(), HasSubstr("transforms/@15\n")) << "no name";
    EXPECT_THAT(target.printed(), HasSubstr("root\n"));
    ASSERT_TRUE(target.script("set transforms/left.name wheel\nlist transforms"));
    EXPECT_EQ(target.printed(), "transforms/@15\ntransforms/wheel@13\ntransforms/wheel@14\n");
}

TEST(Paths, EveryPrintedPathReadsBack) {
    FakeTarget target;
    ASSERT_TRUE(
        target.script("create light \"a @1 / . # \\\\ \\\" = , *\"\ncreate light \"in\"\ncreate light a/b.c\n"
                      "create material \"\\x01\\n\"\ncreate material \"x@3\""));
    ASSERT_TRUE(target.script("list"));
    const std::string list = target.printed();
    std::string shows;
    for (std::size_t at = 0; at < list.size();) {
        const std::size_t end = list.find('\n', at);
        shows += "show " + list.substr(at, end - at) + "\n";
        at = end + 1;
    }
    EXPECT_TRUE(target.script(shows)) << target.error();
    EXPECT_EQ(target.calls.size(), 1 + target.scene().objects().size())
        << "the first script, and writers of each";
}

struct Wrong {
    const char* line;
    const char* column;
    const char* text;
};

class WrongPath : public testing::TestWithParam<Wrong> {};

TEST_P(WrongPath, NamesColumnCauseAndRemedy) {
    FakeTarget target;
    ASSERT_TRUE(target.script("set transforms/left.name wheel"));
    const Hash128 before = target.scene().state_hash();
    EXPECT_FALSE(target.script(GetParam().line));
    EXPECT_THAT(target.error(), testing::StartsWith(std::string("test.txt:1:") + GetParam().column + ": "));
    EXPECT_THAT(target.error(), HasSubstr(GetParam().text));
    EXPECT_EQ(target.scene().state_hash(), before);
}

INSTANTIATE_TEST_SUITE_P(
    Paths, WrongPath,
    testing::Values(Wrong{"show lihgts/bulb", "6", "did you mean 'lights'?"},
                    Wrong{"show lights/blub", "13", "did you mean 'bulb'?"},
                    Wrong{"show lights/qqqqqqqqqq", "13", "see 'list lights'"},
                    Wrong{"show transforms/wheel", "17", "transforms/wheel@13, transforms/wheel@14"},
                    Wrong{"show bulb", "6", "KIND/NAME"}, Wrong{"show lights", "6", "lights/NAME"},
                    Wrong{"show lights/", "6", "has no name"}, Wrong{"show lights/a@b", "15", "quote names"},
                    Wrong{"show lights/@4000", "6", "there is no object 4000"},
                    Wrong{"show lights/@2", "6", "object 2 is textures/wood@2"},
                    Wrong{"show lights/@99999999999999999999999", "14", "is not an id"}));

}  // namespace
}  // namespace tessera::edit
