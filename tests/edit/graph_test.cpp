#include <numbers>

#include "tests/edit/fake_target.h"

namespace tessera::edit {
namespace {

using testing::HasSubstr;

bool contains(const std::vector<ObjectId>& ids, ObjectId id) {
    return std::find(ids.begin(), ids.end(), id) != ids.end();
}

const std::vector<ObjectId>& root_children(const FakeTarget& target) {
    return target.scene().find_as<scene::Root>(scene::RootId)->children;
}

TEST(Graph, MoveAddsInTheParentsFrame) {
    FakeTarget target;
    const glm::dmat4 before = target.named<scene::Transform>("wheel").matrix;
    ASSERT_TRUE(target.script("move transforms/wheel 1 -2 0.5\nmove transforms/wheel 0,0,1"))
        << target.error();
    glm::dmat4 expected = before;
    expected[3] += glm::dvec4(1, -2, 0.5, 0);
    expected[3] += glm::dvec4(0, 0, 1, 0);
    EXPECT_EQ(target.named<scene::Transform>("wheel").matrix, expected);
}

TEST(Graph, RotateIsAboutTheLocalOrigin) {
    FakeTarget target;
    ASSERT_TRUE(
        target.script("set transforms/left.matrix 1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1\n"
                      "rotate transforms/left z 90\nrotate transforms/left 0 2 0 90"))
        << target.error();
    const glm::dmat4 matrix = target.named<scene::Transform>("left").matrix;
    // x turns to y about z, which stays y about y; y turns to -x, then to z.
    const glm::dvec4 expected[3] = {{0, 1, 0, 0}, {0, 0, 1, 0}, {1, 0, 0, 0}};
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 4; ++row) EXPECT_NEAR(matrix[column][row], expected[column][row], 1e-15);
    }
    EXPECT_EQ(matrix[3], glm::dvec4(5, 6, 7, 1));
}

TEST(Graph, ScaleIsAlongTheLocalAxes) {
    FakeTarget target;
    ASSERT_TRUE(target.script("scale transforms/left 2\nscale transforms/left 1 1 0.5")) << target.error();
    const glm::dmat4 matrix = target.named<scene::Transform>("left").matrix;
    EXPECT_EQ(glm::dvec3(matrix[0][0], matrix[1][1], matrix[2][2]), glm::dvec3(2, -4, 3));
}

TEST(Graph, OnlyTransformsCanBeMoved) {
    FakeTarget target;
    EXPECT_FALSE(target.script("move lights/bulb 1 2 3"));
    EXPECT_THAT(target.error(), HasSubstr("1:6: lights/bulb is not a transform"));
    EXPECT_FALSE(target.script("rotate transforms/left 0 0 0 90"));
    EXPECT_FALSE(target.script("rotate transforms/left w 90"));
    EXPECT_FALSE(target.script("scale transforms/left 1 2"));
    EXPECT_FALSE(target.script("move transforms/left 1 2"));
}

TEST(Graph, CreateMakesAnObjectWithFieldsAndParent) {
    FakeTarget target;
    ASSERT_TRUE(
        target.script("create light key kind=spot intensity=10,9,8 outer_cone_angle=0.5 in transforms/left\n"
                      "create transform \"new one\"\ncreate light below in transforms/\"new one\"\n"
                      "create material gold diffuse=1,0.8,0.2 metallic=1 base_color_texture=textures/wood\n"
                      "create attachment note key=a value=\"b c\" in root"))
        << target.error();
    const auto& key = target.named<scene::Light>("key");
    EXPECT_EQ(key.kind, scene::LightKind::Spot);
    EXPECT_EQ(key.intensity, glm::vec3(10, 9, 8));
    EXPECT_TRUE(contains(target.named<scene::Transform>("left").children, target.id_of("key")));
    EXPECT_TRUE(contains(root_children(target), target.id_of("new one")));
    EXPECT_TRUE(contains(target.named<scene::Transform>("new one").children, target.id_of("below")));
    const auto& gold = target.named<scene::Material>("gold");
    EXPECT_EQ(gold.base_color, glm::vec4(1.0f, 0.8f, 0.2f, 1.0f));
    EXPECT_EQ(gold.base_color_texture.texture, target.id_of("wood"));
    EXPECT_EQ(target.named<scene::Attachment>("note").value, "b c");
    EXPECT_EQ(target.labels.size(), 1u) << "one transaction";
}

TEST(Graph, CreateRejectsInvalidArguments) {
    FakeTarget target;
    for (const auto& [line, text] : {std::pair("create geometry box", "cannot be typed"),
                                     {"create texture t", "cannot be typed"},
                                     {"create root r", "one root"},
                                     {"create material m in root", "omit 'in'"},
                                     {"create light l in lights/bulb", "cannot have children"},
                                     {"create light l in", "needs the path"},
                                     {"create light l in root x=1", "unexpected 'x=1' after 'in PARENT'"},
                                     {"create light l kind", "not FIELD=VALUE"},
                                     {"create light l knd=spot", "did you mean 'kind'?"},
                                     {"create lamp l", "no kind of object"},
                                     {"create light", "needs more"}}) {
        EXPECT_FALSE(target.script(line)) << line;
        EXPECT_THAT(target.error(), HasSubstr(text));
    }
}

TEST(Graph, AttachAndDetach) {
    FakeTarget target;
    const ObjectId bulb = target.id_of("bulb");
    ASSERT_TRUE(target.script("attach lights/bulb in root")) << target.error();
    EXPECT_TRUE(contains(root_children(target), bulb));
    EXPECT_FALSE(target.script("attach lights/bulb in root"));
    EXPECT_THAT(target.error(), HasSubstr("is already in root"));
    ASSERT_TRUE(target.script("detach lights/bulb from root")) << target.error();
    EXPECT_FALSE(contains(root_children(target), bulb));
    EXPECT_TRUE(contains(target.named<scene::Transform>("left").children, bulb));
    ASSERT_TRUE(target.script("attach lights/bulb in root\ndetach lights/bulb")) << target.error();
    EXPECT_FALSE(contains(root_children(target), bulb));
    EXPECT_FALSE(contains(target.named<scene::Transform>("left").children, bulb));
    EXPECT_NE(target.scene().find(bulb), nullptr) << "it stays in the scene";
    EXPECT_FALSE(target.script("detach lights/bulb"));
    EXPECT_FALSE(target.script("attach materials/\"my \\\"red\\\"\" in root"));
}

TEST(Graph, CycleIsRejectedWithItsLine) {
    FakeTarget target;
    EXPECT_FALSE(target.script("move transforms/left 1 0 0\n\nattach transforms/left in transforms/wheel"));
    EXPECT_THAT(target.error(), HasSubstr("test.txt:3:1: "));
    EXPECT_THAT(target.error(), HasSubstr("own descendants"));
    EXPECT_TRUE(target.labels.empty());
}

TEST(Graph, RemoveClearsReferencesAndKeepsDependencies) {
    FakeTarget target;
    const std::size_t before = target.scene().objects().size();
    ASSERT_TRUE(
        target.script("remove textures/wood\nremove transforms/wheel\nremove textures/sky\n"
                      "remove materials/\"my \\\"red\\\"\"\nremove backgrounds/evening"))
        << target.error();
    EXPECT_EQ(target.scene().objects().size(), before - 5);
    EXPECT_FALSE(target.scene().find_as<scene::Root>(scene::RootId)->background);
    EXPECT_FALSE(target.named<scene::Geometry>("square").material);
    EXPECT_EQ(target.named<scene::Transform>("left").children.size(), 1u);
    EXPECT_FALSE(target.script("remove root"));
}

TEST(Graph, RecursiveRemoveDeletesUnusedDependencies) {
    FakeTarget target;
    const std::size_t before = target.scene().objects().size();
    // The wheel's second square is used by nothing else; the first is in the root, too, and keeps its
    // material.
    ASSERT_TRUE(target.script("remove transforms/wheel -r")) << target.error();
    EXPECT_EQ(target.scene().objects().size(), before - 3) << "wheel, second square, attachment";
    target.named<scene::Geometry>("square");
    ASSERT_TRUE(target.script("remove -r geometries/square")) << target.error();
    EXPECT_EQ(target.scene().objects().size(), before - 7) << "square, material, two textures";
    target.named<scene::Texture>("sky");
}

}  // namespace
}  // namespace tessera::edit
