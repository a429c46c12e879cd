#include "client/edit/completion.h"

#include "client/edit/commands.h"
#include "tests/edit/fake_target.h"
#include "tests/import/scene_file.h"

namespace tessera::edit {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;

class CompletionTest : public testing::Test {
  protected:
    // Completes at the bar.
    std::vector<std::string> at(std::string text) {
        const std::size_t cursor = text.find('|');
        text.erase(cursor, 1);
        const Completion found = complete(text, cursor, target_.scene());
        begin_ = found.begin;
        return found.candidates;
    }
    FakeTarget target_;
    std::size_t begin_ = 0;
};

TEST_F(CompletionTest, OfCommands) {
    EXPECT_EQ(at("|").size(), commands().size());
    EXPECT_THAT(at("se|"), ElementsAre("set "));
    EXPECT_THAT(at("  ro|"), ElementsAre("rollback ", "rotate "));
    EXPECT_EQ(begin_, 2u);
    EXPECT_THAT(at("nonsense |"), IsEmpty());
}

TEST_F(CompletionTest, OfPathsFirstKindsThenNames) {
    EXPECT_THAT(at("show li|"), ElementsAre("lights/"));
    EXPECT_THAT(at("show lights/s|"), ElementsAre("lights/spot ", "lights/sun "));
    EXPECT_EQ(begin_, 5u);
    EXPECT_THAT(at("show transforms/|"),
                ElementsAre("transforms/@15 ", "transforms/left ", "transforms/wheel "));
    EXPECT_THAT(at("show materials/|"), ElementsAre("materials/\"my \\\"red\\\"\" "));
    EXPECT_THAT(at("show materials/\"my |"), ElementsAre("materials/\"my \\\"red\\\"\" "));
    EXPECT_EQ(begin_, 5u) << "a blank inside of quotes begins no word";
    EXPECT_THAT(at("show r|"), ElementsAre("root "));
    EXPECT_THAT(at("move |"), ElementsAre("transforms/@15 ", "transforms/left ", "transforms/wheel "));
}

TEST_F(CompletionTest, OfFieldsAndTheirValues) {
    EXPECT_THAT(at("set lights/su|"), ElementsAre("lights/sun."));
    EXPECT_THAT(at("set lights/sun.in|"),
                ElementsAre("lights/sun.inner_cone_angle ", "lights/sun.intensity "));
    EXPECT_THAT(
        at("set materials/\"my \\\"red\\\"\".d|"),
        ElementsAre("materials/\"my \\\"red\\\"\".diffuse ", "materials/\"my \\\"red\\\"\".double_sided "));
    EXPECT_THAT(at("set geometries/square.|"), testing::Not(Contains("geometries/square.positions ")));
    EXPECT_THAT(at("set lights/sun.kind |"),
                ElementsAre("directional ", "point ", "quad ", "sphere ", "spot "));
    EXPECT_THAT(at("set lights/sun.kind sp|"), ElementsAre("sphere ", "spot "));
    EXPECT_THAT(at("set root.background b|"), ElementsAre("backgrounds/"));
    EXPECT_THAT(at("set root.background n|"), ElementsAre("none "));
    EXPECT_THAT(at("set materials/\"my \\\"red\\\"\".normal_texture textures/data s|"),
                ElementsAre("scale=", "set="));
    EXPECT_THAT(at("set lights/none.kind |"), IsEmpty());
}

TEST_F(CompletionTest, OfCreateAndItsKeyword) {
    EXPECT_THAT(at("create ma|"), ElementsAre("material "));
    EXPECT_THAT(at("create light x ki|"), ElementsAre("kind="));
    EXPECT_THAT(at("create light x kind=d|"), ElementsAre("kind=directional "));
    EXPECT_THAT(at("create material x base_color_texture=tex|"), ElementsAre("base_color_texture=textures/"));
    EXPECT_THAT(at("create light x in|"), Contains("in "));
    EXPECT_THAT(at("create light x in r|"), ElementsAre("root "));
    EXPECT_THAT(at("attach lights/sun i|"), ElementsAre("in "));
    EXPECT_THAT(at("attach lights/sun in transforms/l|"), ElementsAre("transforms/left "));
}

TEST_F(CompletionTest, OfTopics) {
    EXPECT_THAT(at("help pa|"), ElementsAre("paths "));
    EXPECT_THAT(at("help mat|"), ElementsAre("materials "));
}

TEST_F(CompletionTest, OfFiles) {
    import::TestFolder folder;
    for (const char* name : {"a.glb", "a b.tessera", "a.txt"}) folder.write(name, "");
    std::filesystem::create_directory(folder.path() / "ab");
    const std::string path = folder.path().string();
    EXPECT_THAT(at("load " + path + "/a|"),
                ElementsAre("\"" + path + "/a b.tessera\" ", path + "/a.glb ", path + "/ab/"));
    EXPECT_THAT(at("load \"" + path + "/a |"), ElementsAre("\"" + path + "/a b.tessera\" "));
    EXPECT_THAT(at("load " + path + "/nowhere/|"), IsEmpty());
}

TEST_F(CompletionTest, IgnoresTextAfterTheCursor) {
    EXPECT_THAT(at("show lights/s|un lights/bulb"), ElementsAre("lights/spot ", "lights/sun "));
    EXPECT_NO_THROW(complete("show", 1000, target_.scene()));
}

}  // namespace
}  // namespace tessera::edit
