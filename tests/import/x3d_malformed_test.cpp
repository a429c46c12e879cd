#include "mediator/base/random.h"
#include "tests/import/x3d_file.h"

// Malformed X3D files: one clear error, or a counted notice while the rest is rendered.
namespace tessera::import {
namespace {

using testing::HasSubstr;

std::string x3d_error(const std::string& text, const std::string& name = "a.x3d") {
    const TestFolder folder;
    const auto scene = import_scene(folder.write(name, text));
    if (scene) {
        ADD_FAILURE() << "it was read";
        return "";
    }
    EXPECT_EQ(scene.error().code(), ErrorCode::InvalidInput);
    EXPECT_THAT(scene.error().what(), HasSubstr(name));
    EXPECT_LT(std::string(scene.error().what()).size(), 1000u);
    return scene.error().what();
}

std::string repeated(const std::string& text, std::size_t times) {
    std::string all;
    for (std::size_t i = 0; i < times; ++i) all += text;
    return all;
}

constexpr const char* Good = "<Shape><Box/></Shape>";

TEST(X3dMalformed, BrokenXmlNamesTheLine) {
    EXPECT_THAT(x3d_error("<?xml version='1.0'?>\n<X3D>\n<Scene>\n<Shape>\n</Scene></X3D>"),
                HasSubstr("line 5: the XML is broken"));
    EXPECT_THAT(x3d_error(""), HasSubstr("the XML is broken"));
    EXPECT_THAT(x3d_error("<X3D version='3.3"), HasSubstr("the XML is broken"));
    EXPECT_THAT(x3d_error("\n<html><Scene/></html>"), HasSubstr("line 2: it begins with <html>"));
    EXPECT_THAT(x3d_error("<X3D><head/></X3D>"), HasSubstr("has no <Scene>"));
    EXPECT_THAT(x3d_error(std::string("<\0?\0x\0m\0", 8)), HasSubstr("UTF-8"));
    EXPECT_THAT(x3d_error(x3d("")), HasSubstr("nothing to render"));
    EXPECT_THAT(x3d_error(x3d("<Shape><Extrusion/></Shape><Shape><Text/></Shape><Shape><Text/></Shape>")),
                HasSubstr("skipped: 1 <Extrusion>, 2 <Text>"));
    EXPECT_THAT(x3d_error("#VRML V2.0 utf8", "a.wrl"), HasSubstr("convert it to .x3d"));
}

TEST(X3dMalformed, EntitiesAreNotExpanded) {
    std::string laughs = "<?xml version='1.0'?>\n<!DOCTYPE X3D [<!ENTITY a 'ha'>";
    for (char c = 'b'; c < 'z'; ++c) {
        laughs += std::string("<!ENTITY ") + c + " '" +
                  repeated(std::string("&") + static_cast<char>(c - 1) + ";", 10) + "'>";
    }
    laughs += "]>\n<X3D><Scene><Shape DEF='&y;'><Box size='&y;'/></Shape></Scene></X3D>";
    const TestFolder folder;
    const ImportedScene scene = loaded(folder.write("a.x3d", laughs));
    EXPECT_EQ(only_geometry(scene).name, "&y;");
    EXPECT_TRUE(has_notice(scene, "size is '&y;', '&y;' is not a valid number: its default is used"));
}

TEST(X3dMalformed, DeepNestingEnds) {
    constexpr std::size_t Depth = 100'000;
    const ImportedScene scene =
        read_x3d(Good + repeated("<Group>", Depth) + Good + repeated("</Group>", Depth));
    EXPECT_EQ(scene.counts.instances, 1u);
    EXPECT_TRUE(has_notice(scene, "nested more than 512 deep"));
    // By USE: 40 chains of 100 nodes, each below the previous one.
    std::string chains = "<Group DEF='c0'>" + std::string(Good) + "</Group>";
    for (int i = 1; i <= 40; ++i) {
        chains += repeated("<Group>", 99) + "<Group DEF='c" + std::to_string(i) + "'>" +
                  repeated("<Group>", 99) + "<Group USE='c" + std::to_string(i - 1) + "'/>" +
                  repeated("</Group>", 199);
    }
    EXPECT_TRUE(has_notice(read_x3d(chains), "nested more than 512 deep"));
}

TEST(X3dMalformed, ExponentialGrowthByUseIsRejected) {
    std::string doubling = "<Group DEF='g0'>" + std::string(Good) + "</Group>", empty = Good;
    for (int i = 1; i <= 60; ++i) {
        const std::string before = "<Group USE='g" + std::to_string(i - 1) + "'/>";
        doubling += "<Group DEF='g" + std::to_string(i) + "'>" + before + before + "</Group>";
    }
    EXPECT_THAT(x3d_error(x3d(doubling)), HasSubstr("split the scene"));
    const std::size_t first = doubling.find(Good);
    doubling.erase(first, std::string(Good).size());
    EXPECT_THAT(x3d_error(x3d(Good + doubling)), HasSubstr("split the scene")) << "also of nothing";
}

TEST(X3dMalformed, UseWithoutDefAndInsideItself) {
    const ImportedScene scene =
        read_x3d(std::string(Good) +
                 "\n<Group USE='later'/><Shape DEF='later'><Box/></Shape>\n<Group DEF='me'><Group>"
                 "<Group USE='me'/></Group></Group><Shape><Appearance USE='me'/><Box/></Shape>");
    EXPECT_TRUE(has_notice(scene, "USE='later' refers to no earlier DEF: the node is ignored (line 4)"));
    EXPECT_TRUE(has_notice(scene, "USE='me' is inside its own DEF: the node is ignored (line 5)"));
    EXPECT_TRUE(has_notice(scene, "<Group> skipped"));
    EXPECT_EQ(scene.counts.instances, 3u);
}

TEST(X3dMalformed, WrongFieldsFallBackToTheirDefaults) {
    const ImportedScene scene = read_x3d(
        "<Shape><Box size='1 2'/></Shape><Shape><Sphere radius='-1'/></Shape><Shape><Cone "
        "height='1e999'/></Shape>"
        "<Shape><Cylinder radius='nan' height='0' top='maybe'/></Shape>"
        "<Transform rotation='0 0 0 1' scale='1 1 1 1' translation='1 2 x'/>"
        "<PointLight intensity='-3' color='1 inf 1'/><Viewpoint fieldOfView='4'/>"
        "<SpotLight direction='0 0 0' cutOffAngle='3'/>");
    for (const char* problem :
         {"<Box> size is '1 2', not 3 numbers: its default is used, correct it (line 3)",
          "<Sphere> radius is '-1', not greater than 0",
          "<Cone> height is '1e999', '1e999' is not a valid number", "<Cylinder> radius is 'nan'",
          "<Cylinder> height is '0'", "<Cylinder> top is 'maybe', neither",
          "<Transform> rotation has an axis of length zero", "<Transform> scale is '1 1 1 1', not 3 numbers",
          "<Transform> translation is '1 2 x', 'x' is not a valid number",
          "<PointLight> intensity is '-3', negative", "<PointLight> color is '1 inf 1'",
          "<Viewpoint> fieldOfView is '4', outside", "<SpotLight> direction has length zero",
          "<SpotLight> cutOffAngle is '3', outside"}) {
        EXPECT_TRUE(has_notice(scene, problem));
    }
    EXPECT_EQ(scene.counts.instances, 4u);
    EXPECT_EQ(scene.counts.placeholders, 0u);
}

TEST(X3dMalformed, BadMeshesAreAPlaceholder) {
    const auto cause = [](const std::string& fields, const std::string& points,
                          const std::string& more = "") {
        const ImportedScene scene = read_x3d("<Shape><IndexedFaceSet " + fields + "><Coordinate point='" +
                                             points + "'/>" + more + "</IndexedFaceSet></Shape>");
        EXPECT_EQ(scene.counts.placeholders, 1u);
        EXPECT_TRUE(has_notice(scene, "a magenta box replaces it, correct it (line 3)"));
        std::string all;
        for (const std::string& notice : scene.notices) all += notice + "\n";
        return all;
    };
    const std::string points = "0 0 0 1 0 0 0 1 0";
    EXPECT_THAT(cause("coordIndex='0 1 3'", points), HasSubstr("index 3 is out of range for its 3 points"));
    EXPECT_THAT(cause("coordIndex='0 1 2147483648'", points),
                HasSubstr("'2147483648' is not a valid number"));
    EXPECT_THAT(cause("coordIndex='0 1 1.5'", points), HasSubstr("'1.5' is not a valid number"));
    EXPECT_THAT(cause("coordIndex='0 1 2'", "0 0 0 1 0 0 0 1"),
                HasSubstr("8 numbers are not a multiple of 3"));
    EXPECT_THAT(cause("coordIndex='0 1 2'", "0 0 0 1 0 nan 0 1 0"), HasSubstr("'nan' is not a valid number"));
    EXPECT_THAT(cause("coordIndex='0 1 2'", "0 0 0 1 0 1e38 0 1 1e19"), HasSubstr("is not a valid number"));
    EXPECT_THAT(cause("", points), HasSubstr("no triangles"));
    EXPECT_THAT(cause("coordIndex='-1 -1 0 1 -1'", points), HasSubstr("no triangles"));
    EXPECT_THAT(cause("coordIndex='0 1 2' normalIndex='0 1'", points, "<Normal vector='0 0 1 0 0 1'/>"),
                HasSubstr("fewer indices of normals"));
    EXPECT_THAT(cause("coordIndex='0 1 2'", points, "<Normal vector='0 0 1'/>"),
                HasSubstr("index 1 is out of range for its 1 normals"));
    EXPECT_THAT(
        cause("coordIndex='0 1 2' texCoordIndex='0 0 -1'", points, "<TextureCoordinate point='0 0'/>"),
        HasSubstr("index -1 is out of range"));
    EXPECT_THAT(cause("coordIndex='0 1 2'", points, "<Color color='1 0 0 1 0 0 2 0 0'/>"),
                HasSubstr("outside 0 to 1"));
    EXPECT_THAT(cause("coordIndex='0 1 2'><Coordinate/></IndexedFaceSet><IndexedFaceSet", points),
                HasSubstr("is out of range for its 0 points"));
}

TEST(X3dMalformed, AFanOfManyFacesEnds) {
    std::string indices, points = "0 0 0 ";
    constexpr int FaceCount = 200'000;  // a quadratic comparison would time out
    for (int i = 1; i <= FaceCount + 1; ++i) {
        points += std::to_string(i) + " " + std::to_string(i % 7) + " 1 ";
        if (i <= FaceCount) indices += "0 " + std::to_string(i) + " " + std::to_string(i + 1) + " -1 ";
    }
    const ImportedScene scene = read_x3d("<Shape><IndexedFaceSet creaseAngle='0.5' coordIndex='" + indices +
                                         "'><Coordinate point='" + points + "'/></IndexedFaceSet></Shape>");
    EXPECT_EQ(scene.counts.triangles, static_cast<std::uint64_t>(FaceCount));
}

TEST(X3dMalformed, ManyProblemsGiveAShortList) {
    std::string nodes = Good;
    for (int i = 0; i < 2000; ++i) {
        nodes += "<N" + std::to_string(i) + "/><Group USE='u" + std::to_string(i) + "'/>";
    }
    const ImportedScene scene = read_x3d(nodes);
    EXPECT_LT(scene.notices.size(), 150u);
    EXPECT_TRUE(has_notice(scene, "other problems"));
}

TEST(X3dMalformed, NamesBecomeValidUtf8) {
    const ImportedScene scene =
        read_x3d("<Shape DEF='a\xff\xc3' ><Box/></Shape><Group DEF='" + std::string(10'000, 'x') + "'/>");
    EXPECT_EQ(only_geometry(scene).name, "a??");
    for (const scene::Transform* transform : all<scene::Transform>(scene))
        EXPECT_LE(transform->name.size(), 260u);
}

}  // namespace
}  // namespace tessera::import
