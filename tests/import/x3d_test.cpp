#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "tests/import/x3d_file.h"

// Graphs, lights, cameras and backgrounds of X3D files.
namespace tessera::import {
namespace {

using testing::ElementsAre;

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double error = 1e-9) {
    EXPECT_LT(glm::distance(a, b), error)
        << a.x << " " << a.y << " " << a.z << " instead of " << b.x << " " << b.y << " " << b.z;
}

glm::dvec3 moved(const glm::dmat4& matrix, const glm::dvec3& point) {
    return glm::dvec3(matrix * glm::dvec4(point, 1.0));
}

// The parent transform of the object.
const scene::Transform& parent_of(const ImportedScene& scene, const scene::Object& child) {
    ObjectId id;
    for (const scene::Create& create : scene.objects) {
        if (&create.object == &child) id = create.id;
    }
    for (const scene::Transform* transform : all<scene::Transform>(scene)) {
        for (const ObjectId each : transform->children) {
            if (each == id) return *transform;
        }
    }
    ADD_FAILURE() << "it has no parent transform";
    static const scene::Transform none;
    return none;
}

template <class T>
const scene::Transform& parent_of_first(const ImportedScene& scene) {
    for (const scene::Create& create : scene.objects) {
        if (std::holds_alternative<T>(create.object)) return parent_of(scene, create.object);
    }
    ADD_FAILURE() << "there is no such object";
    static const scene::Transform none;
    return none;
}

TEST(X3d, DefaultsOfATransformMoveNothing) {
    const ImportedScene scene = read_x3d("<Transform DEF='t'><Shape><Box/></Shape></Transform>");
    EXPECT_EQ(named<scene::Transform>(scene, "t").matrix, glm::dmat4(1.0));
    EXPECT_TRUE(has_notice(scene, "no camera"));
    EXPECT_TRUE(has_notice(scene, "no light"));
}

TEST(X3d, TransformsFieldByField) {
    const auto point = [](const std::string& fields) {
        const ImportedScene scene =
            read_x3d("<Transform DEF='t' " + fields + "><Shape><Box/></Shape></Transform>");
        return moved(named<scene::Transform>(scene, "t").matrix, {1, 2, 3});
    };
    expect_near(point("translation='1,0 0'"), {2, 2, 3});
    expect_near(point("scale='2 3 4'"), {2, 6, 12});
    expect_near(point("rotation='0 0 2 1.5707963267948966'"), {-2, 1, 3});
    expect_near(point("center='1 2 3' scale='5 5 5' rotation='1 0 0 2'"), {1, 2, 3});
    // Scale 2 along the axis (1 1 0): adds that component of the point, (1.5 1.5 0).
    expect_near(point("scaleOrientation='0 0 1 0.7853981633974483' scale='2 1 1'"), {2.5, 3.5, 3});
    // Combined, in the order of the standard: scale, rotate, translate.
    expect_near(
        point("translation='10 0 0' rotation='0 0 1 1.5707963267948966' scale='2 1 1' center='1 0 0'"),
        {10 + 1 - 2, 0, 3});
}

TEST(X3d, GroupsNest) {
    const ImportedScene scene = read_x3d(
        "<Group><Transform translation='0 1 0'><Group><Transform DEF='in' scale='2 2 2'><Shape><Box/></Shape>"
        "</Transform></Group></Transform></Group><Viewpoint/>");
    EXPECT_EQ(scene.counts.instances, 1u);
    EXPECT_EQ(all<scene::Transform>(scene).size(), 5u);
}

TEST(X3d, NodesUsedAgainAreShared) {
    const ImportedScene scene = read_x3d(
        "<Transform DEF='T' translation='1 0 0'><Shape DEF='S'><Appearance DEF='A'><Material DEF='M'/>"
        "</Appearance><Sphere DEF='G'/></Shape></Transform><Transform translation='0 5 0'><Transform "
        "USE='T'/>"
        "<Shape USE='S'/></Transform><Shape><Appearance USE='A'/><Sphere USE='G'/></Shape>"
        "<Shape><Appearance><Material USE='M'/></Appearance><Sphere USE='G'/></Shape>");
    EXPECT_EQ(scene.counts.instances, 5u);
    EXPECT_EQ(scene.counts.geometries, 2u) << "one for each Appearance";
    EXPECT_EQ(all<scene::Geometry>(scene)[0]->positions, all<scene::Geometry>(scene)[1]->positions);
    EXPECT_EQ(named<scene::Geometry>(scene, "S").indices.byte_size, 12u * (2 * 72 * 35));
    EXPECT_EQ(named<scene::Transform>(scene, "T").children.size(), 1u);
}

TEST(X3d, TheNearestEarlierDefinitionIsUsed) {
    const ImportedScene scene = read_x3d(
        "<Shape DEF='S'><Box/></Shape><Transform DEF='a'><Shape USE='S'/></Transform>"
        "<Shape DEF='S'><Cone/></Shape><Transform DEF='b'><Shape USE='S'/></Transform>");
    const auto triangles = [&](const char* name) {
        const ObjectId id = named<scene::Transform>(scene, name).children.at(0);
        return object<scene::Geometry>(scene, id).indices.byte_size / 12;
    };
    EXPECT_EQ(triangles("a"), 12u);
    EXPECT_EQ(triangles("b"), 72u + 70u);
}

TEST(X3d, LightsAndTheirDefaults) {
    const std::string box = "<Shape><Box/></Shape>";
    const ImportedScene point = read_x3d(box + "<PointLight DEF='p'/>");
    const scene::Light& light = named<scene::Light>(point, "p");
    EXPECT_EQ(light.kind, scene::LightKind::Point);
    EXPECT_EQ(light.intensity, glm::vec3(static_cast<float>(std::numbers::pi)));
    EXPECT_EQ(parent_of_first<scene::Light>(point).matrix, glm::dmat4(1.0));

    const ImportedScene spot = read_x3d(box + "<SpotLight DEF='s'/>");
    EXPECT_FLOAT_EQ(named<scene::Light>(spot, "s").outer_cone_angle,
                    static_cast<float>(std::numbers::pi / 2));
    EXPECT_FLOAT_EQ(named<scene::Light>(spot, "s").inner_cone_angle,
                    static_cast<float>(std::numbers::pi / 4));
    EXPECT_EQ(read_x3d(box + "<DirectionalLight/>").counts.lights, 1u);
    EXPECT_EQ(read_x3d(box + "<DirectionalLight on='false'/>").counts.lights, 0u);
}

TEST(X3d, LightsPointInTheirDirection) {
    const ImportedScene scene = read_x3d(
        "<Shape><Box/></Shape><Transform translation='0 0 1'><SpotLight DEF='s' location='1 2 3' "
        "direction='0 -3 0' beamWidth='1' cutOffAngle='0.5' color='1 0.5 0' intensity='2' radius='5' "
        "attenuation='0 0 1'/></Transform>");
    const scene::Light& light = named<scene::Light>(scene, "s");
    EXPECT_FLOAT_EQ(light.outer_cone_angle, 0.5f);
    EXPECT_FLOAT_EQ(light.inner_cone_angle, 0.5f) << "no wider than the outer angle";
    EXPECT_FLOAT_EQ(light.intensity.x, static_cast<float>(2 * std::numbers::pi));
    EXPECT_FLOAT_EQ(light.intensity.y, static_cast<float>(std::numbers::pi));
    const glm::dmat4 matrix = parent_of_first<scene::Light>(scene).matrix;
    expect_near(moved(matrix, {0, 0, 0}), {1, 2, 3});
    expect_near(moved(matrix, {0, 0, -1}), {1, 1, 3});
}

TEST(X3d, Viewpoints) {
    const ImportedScene plain = read_x3d("<Shape><Box/></Shape><Viewpoint/>");
    ASSERT_EQ(plain.cameras.size(), 1u);
    EXPECT_DOUBLE_EQ(plain.cameras[0].camera.vertical_fov, std::numbers::pi / 4);
    expect_near(moved(plain.cameras[0].world_from_camera, {0, 0, -1}), {0, 0, 9});

    const ImportedScene placed = read_x3d(
        "<Shape><Box/></Shape><Transform translation='0 0 1' scale='2 2 2'><Viewpoint description='from "
        "afar' "
        "position='1 0 2' orientation='0 1 0 1.5707963267948966' fieldOfView='0.5'/></Transform>"
        "<Viewpoint DEF='second'/>");
    ASSERT_EQ(placed.cameras.size(), 2u);
    EXPECT_EQ(placed.cameras[0].name, "from afar");
    EXPECT_EQ(placed.cameras[1].name, "second");
    EXPECT_DOUBLE_EQ(placed.cameras[0].camera.vertical_fov, 0.5);
    expect_near(moved(placed.cameras[0].world_from_camera, {0, 0, 0}), {2, 0, 5});
    expect_near(moved(placed.cameras[0].world_from_camera, {0, 0, -1}), {1, 0, 5});
}

TEST(X3d, ACameraWithSeveralInstancesIsOne) {
    const ImportedScene scene = read_x3d(
        "<Shape><Box/></Shape><Transform translation='1 0 0'><Viewpoint DEF='v'/></Transform>"
        "<Transform translation='2 0 0'><Viewpoint USE='v'/></Transform>");
    ASSERT_EQ(scene.cameras.size(), 1u);
    expect_near(moved(scene.cameras[0].world_from_camera, {0, 0, 0}), {1, 0, 10});
}

TEST(X3d, BackgroundOfOneColour) {
    const ImportedScene scene = read_x3d("<Shape><Box/></Shape><Background DEF='b' skyColor='0.1 0.2 0.3'/>");
    EXPECT_EQ(named<scene::Background>(scene, "b").color, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_FALSE(named<scene::Background>(scene, "b").environment);
    ImportOptions options;
    options.background = glm::vec3(1.0f);
    const ImportedScene other =
        read_x3d("<Shape><Box/></Shape><Background skyColor='0.1 0.2 0.3, 1 1 1' skyAngle='1'/>", options);
    EXPECT_EQ(all<scene::Background>(other).at(0)->color, glm::vec3(1.0f));
    EXPECT_TRUE(all<scene::Texture>(other).empty());
}

TEST(X3d, BackgroundGradientIsATexture) {
    const ImportedScene scene = read_x3d(
        "<Shape><Box/></Shape><Background skyColor='1 0 0  0 1 0' skyAngle='1.5707963' "
        "groundColor='0 0 0 0 0 1' groundAngle='0.7853982'/>");
    const scene::Background& background = *all<scene::Background>(scene).at(0);
    const scene::Texture& map = object<scene::Texture>(scene, background.environment);
    const auto texels = values<glm::vec3>(scene, map.texels);
    const auto at = [&](double angle) {  // from the zenith
        return texels.at(static_cast<std::size_t>(angle / std::numbers::pi * map.height) * map.width);
    };
    const double row = std::numbers::pi / map.height;
    expect_near(at(0.0), {1, 0, 0}, row);
    expect_near(at(std::numbers::pi / 4), {0.5, 0.5, 0}, row);
    expect_near(at(std::numbers::pi / 2 + 0.1), {0, 1, 0}, row);
    expect_near(at(0.76 * std::numbers::pi), {0, 0, 0.96}, 2 * row);
    expect_near(at(std::numbers::pi - 0.5 * row), {0, 0, 0}, row);
}

TEST(X3d, UnsupportedNodesAreCountedByKind) {
    const ImportedScene scene = read_x3d(
        "<WorldInfo/><Shape><Box/><MetadataString/></Shape>\n<Text/><Shape><Text/></Shape><Script/>"
        "<ROUTE/><Box/>");
    EXPECT_TRUE(
        has_notice(scene, "<Text> skipped: unsupported, or not supported in this place (line 4 and 1 more)"));
    EXPECT_TRUE(has_notice(scene, "<Script> skipped: unsupported, or not supported in this place (line 4)"));
    EXPECT_TRUE(has_notice(scene, "<Box> skipped"));
    for (const std::string& notice : scene.notices) {
        EXPECT_EQ(notice.find("Metadata"), notice.npos);
        EXPECT_EQ(notice.find("WorldInfo"), notice.npos);
    }
    EXPECT_EQ(scene.counts.instances, 1u);
}

}  // namespace
}  // namespace tessera::import
