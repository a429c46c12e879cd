#include "tests/edit/fake_target.h"

namespace tessera::edit {
namespace {

using testing::HasSubstr;

std::string printed(FakeTarget& target, std::string_view text) {
    EXPECT_TRUE(target.script(text)) << target.error();
    return target.printed();
}

TEST(QueryCommands, ListsByKindAndPattern) {
    FakeTarget target;
    EXPECT_EQ(printed(target, "list lights"), "lights/bulb\nlights/spot\nlights/sun\n");
    EXPECT_EQ(printed(target, "list light"), "lights/bulb\nlights/spot\nlights/sun\n");
    EXPECT_EQ(printed(target, "list lights/s*"), "lights/spot\nlights/sun\n");
    EXPECT_EQ(printed(target, "list */s??"), "textures/sky\nlights/sun\n");
    EXPECT_EQ(printed(target, "list *s/bulb"), "lights/bulb\n");
    EXPECT_EQ(printed(target, "list lights/x*"), "no matches\n");
    EXPECT_FALSE(target.script("list ligts"));
}

TEST(QueryCommands, FindsNamesOfAllKinds) {
    FakeTarget target;
    EXPECT_EQ(printed(target, "find s*"),
              "geometries/square\ngeometries/\"square part 1\"\ntextures/sky\nlights/spot\nlights/sun\n");
}

TEST(QueryCommands, TreeExpandsSharedTransformsOnce) {
    FakeTarget target;
    const std::string tree = printed(target, "tree");
    EXPECT_THAT(tree, testing::StartsWith(
                          "root\n  transforms/left\n    transforms/wheel\n      geometries/square\n"));
    EXPECT_THAT(tree, HasSubstr("  transforms/@15\n    transforms/wheel  (as above)\n    lights/spot\n"));
    EXPECT_THAT(printed(target, "tree transforms/wheel"),
                testing::StartsWith("transforms/wheel\n  geometries/square\n"));
}

TEST(QueryCommands, ShowsFieldsWithTheirWriters) {
    FakeTarget target;
    const std::string text = printed(target, "show lights/bulb");
    EXPECT_THAT(text, testing::StartsWith("lights/bulb@8\n"));
    EXPECT_THAT(text, HasSubstr("\n  name                        bulb\n"));
    EXPECT_THAT(text, HasSubstr("\n  kind                        point   # anna, transaction 7\n"));
    EXPECT_THAT(text, HasSubstr("\n  intensity                   3 2 0.1\n"));
    EXPECT_THAT(printed(target, "show geometries/square"),
                HasSubstr("positions                   48 bytes\n"));
    EXPECT_THAT(printed(target, "show textures/wood"), HasSubstr("texels                      24 bytes\n"));
    EXPECT_THAT(printed(target, "show root"), HasSubstr("background                  backgrounds/evening\n"));
}

TEST(QueryCommands, ShowSeesEarlierEditsOfAScriptAndQueriesWritersAfterThem) {
    FakeTarget target;
    const std::string text =
        printed(target, "create light new intensity=4\nshow lights/new\nset lights/new.intensity 5\n");
    EXPECT_THAT(text, HasSubstr("4 4 4")) << "as it was at that line";
    EXPECT_THAT(text, HasSubstr("transaction 7")) << "the object was there when its writers were asked for";
    EXPECT_EQ(target.named<scene::Light>("new").intensity, glm::vec3(5.0f));
}

}  // namespace
}  // namespace tessera::edit
