#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "tests/import/x3d_file.h"

// Geometry and textures of X3D files.
namespace tessera::import {
namespace {

constexpr double Pi = std::numbers::pi;
using testing::Each;
using testing::ElementsAre;

constexpr const char* Textured =
    "<Appearance><Material/><ImageTexture url='\"https://far.example/t.png\" \"t%20t.png\"'/></Appearance>";

ImportedScene read_textured(const std::string& geometry, const std::string& appearance = Textured) {
    const TestFolder folder;
    folder.write("t t.png", png(2, 2, {200, 100, 50, 255}));
    ImportedScene scene = loaded(folder.write("a.x3d", x3d("<Shape>" + appearance + geometry + "</Shape>")));
    expect_consistent(scene);
    return scene;
}

struct Solid {
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec2> tex_coords;  // v down
    std::vector<std::uint32_t> indices;

    explicit Solid(const std::string& geometry) {
        const ImportedScene scene = read_textured(geometry);
        const scene::Geometry& mesh = only_geometry(scene);
        positions = values<glm::vec3>(scene, mesh.positions);
        normals = values<glm::vec3>(scene, mesh.normals);
        tex_coords = values<glm::vec2>(scene, mesh.tex_coords);
        indices = values<std::uint32_t>(scene, mesh.indices);
    }

    double volume() const {  // by the divergence theorem; valid for closed meshes with outward faces
        double sum = 0.0;
        for (std::size_t i = 0; i < indices.size(); i += 3) {
            const glm::dvec3 a(positions[indices[i]]), b(positions[indices[i + 1]]),
                c(positions[indices[i + 2]]);
            sum += glm::dot(a, glm::cross(b, c)) / 6.0;
        }
        return sum;
    }
    // The texture coordinate at a position, of the vertex whose normal points along `facing`.
    glm::vec2 tex_coord_at(const glm::vec3& position, const glm::vec3& facing) const {
        for (std::size_t i = 0; i < positions.size(); ++i) {
            if (glm::distance(positions[i], position) < 1e-4f && glm::dot(normals[i], facing) > 0.5f)
                return tex_coords[i];
        }
        ADD_FAILURE() << "no vertex at this position";
        return {};
    }
    void expect_normals_outside() const {
        for (std::size_t i = 0; i < indices.size(); i += 3) {
            const glm::dvec3 a(positions[indices[i]]), b(positions[indices[i + 1]]),
                c(positions[indices[i + 2]]);
            const glm::dvec3 flat = glm::normalize(glm::cross(b - a, c - a));
            for (std::size_t k = 0; k < 3; ++k)
                EXPECT_GT(glm::dot(flat, glm::dvec3(normals[indices[i + k]])), 0.99);
        }
    }
};

TEST(X3dPrimitives, VolumesOfTheDefaults) {
    EXPECT_NEAR(Solid("<Box/>").volume(), 8.0, 1e-6);
    EXPECT_NEAR(Solid("<Sphere/>").volume(), 4.0 / 3.0 * Pi, 0.004 * 4.0 / 3.0 * Pi);
    EXPECT_NEAR(Solid("<Cylinder/>").volume(), 2.0 * Pi, 0.002 * 2.0 * Pi);
    EXPECT_NEAR(Solid("<Cone/>").volume(), 2.0 / 3.0 * Pi, 0.002 * 2.0 / 3.0 * Pi);
}

TEST(X3dPrimitives, VolumesOfTheirFields) {
    EXPECT_NEAR(Solid("<Box size='1 2 3'/>").volume(), 6.0, 1e-5);
    EXPECT_NEAR(Solid("<Sphere radius='2'/>").volume(), 32.0 / 3.0 * Pi, 0.15);
    EXPECT_NEAR(Solid("<Cylinder radius='0.5' height='3'/>").volume(), 0.75 * Pi, 0.01);
    EXPECT_NEAR(Solid("<Cone bottomRadius='2' height='3'/>").volume(), 4.0 * Pi, 0.03);
}

TEST(X3dPrimitives, NormalsPointOutside) {
    for (const char* solid : {"<Box size='1 2 3'/>", "<Sphere/>", "<Cylinder/>", "<Cone height='1'/>"}) {
        SCOPED_TRACE(solid);
        Solid(solid).expect_normals_outside();
    }
}

TEST(X3dPrimitives, PartsCanBeLeftOut) {
    const auto triangles = [](const char* solid) { return Solid(solid).indices.size() / 3; };
    EXPECT_EQ(triangles("<Cylinder top='false' bottom='false'/>"), 144u);
    EXPECT_EQ(triangles("<Cylinder side='false' top='false'/>"), 70u);
    EXPECT_EQ(triangles("<Cone bottom='false'/>"), 72u);
    EXPECT_TRUE(has_notice(read_x3d("<Shape><Cone bottom='false' side='false'/></Shape>"), "no triangles"));
}

TEST(X3dPrimitives, TextureCoordinatesFollowTheStandard) {
    const Solid box("<Box/>");
    const glm::vec2 upper_left(0, 0), upper_right(1, 0), lower_left(0, 1);
    EXPECT_EQ(box.tex_coord_at({-1, 1, 1}, {0, 0, 1}), upper_left);
    EXPECT_EQ(box.tex_coord_at({1, 1, -1}, {0, 0, -1}), upper_left);
    EXPECT_EQ(box.tex_coord_at({1, 1, 1}, {1, 0, 0}), upper_left);
    EXPECT_EQ(box.tex_coord_at({-1, 1, -1}, {-1, 0, 0}), upper_left);
    EXPECT_EQ(box.tex_coord_at({-1, 1, -1}, {0, 1, 0}), upper_left);
    EXPECT_EQ(box.tex_coord_at({1, 1, -1}, {0, 1, 0}), upper_right);
    EXPECT_EQ(box.tex_coord_at({-1, -1, 1}, {0, -1, 0}), upper_left);
    EXPECT_EQ(box.tex_coord_at({-1, -1, -1}, {0, -1, 0}), lower_left);
    // The u axis of cylinders starts at the back and runs over the left (-x) to the front.
    for (const char* round : {"<Cylinder/>", "<Sphere/>"}) {
        const Solid solid(round);
        const float y = std::string(round) == "<Sphere/>" ? 0.0f : 1.0f, v = y > 0.0f ? 0.0f : 0.5f;
        EXPECT_EQ(solid.tex_coord_at({-1, y, 0}, {-1, 0, 0}), glm::vec2(0.25f, v));
        EXPECT_EQ(solid.tex_coord_at({0, y, 1}, {0, 0, 1}), glm::vec2(0.5f, v));
    }
    const Solid cylinder("<Cylinder/>");
    EXPECT_LT(glm::distance(cylinder.tex_coord_at({0, 1, -1}, {0, 1, 0}), glm::vec2(0.5f, 0.0f)), 1e-5f);
    EXPECT_LT(glm::distance(cylinder.tex_coord_at({0, -1, 1}, {0, -1, 0}), glm::vec2(0.5f, 0.0f)), 1e-5f);
}

constexpr const char* Square = "<Coordinate point='0 0 0, 2 0 0, 2 1 0, 0 1 0'/>";

TEST(X3dFaceSets, PolygonsOfAnySize) {
    const ImportedScene scene =
        read_x3d("<Shape><IndexedFaceSet coordIndex='0 1 2 3 -1, 0 1 2 -1, 1 2 -1 -1 3 0 1'>" +
                 std::string(Square) + "</IndexedFaceSet></Shape>");
    EXPECT_EQ(scene.counts.triangles, 4u) << "two corners are no face, the last -1 may be missing";
    EXPECT_TRUE(only_geometry(scene).normals.empty()) << "flat";
    EXPECT_TRUE(only_geometry(scene).tex_coords.empty()) << "no texture asks for them";
    const auto points = points_of(scene, only_geometry(scene));
    EXPECT_THAT(std::vector(points.begin(), points.begin() + 3),
                ElementsAre(glm::vec3(0, 0, 0), glm::vec3(2, 0, 0), glm::vec3(2, 1, 0)));
}

TEST(X3dFaceSets, ClockwiseFacesAreFlipped) {
    const ImportedScene scene =
        read_x3d("<Shape><IndexedFaceSet ccw='false' solid='false' creaseAngle='0.1' coordIndex='0 1 2'>" +
                 std::string(Square) + "</IndexedFaceSet></Shape>");
    const auto points = points_of(scene, only_geometry(scene));
    EXPECT_LT(glm::cross(points[1] - points[0], points[2] - points[0]).z, 0.0f);
    EXPECT_THAT(values<glm::vec3>(scene, only_geometry(scene).normals), Each(glm::vec3(0, 0, -1)));
}

TEST(X3dFaceSets, ConcavePolygons) {
    const ImportedScene scene = read_x3d(
        "<Shape><IndexedFaceSet convex='false' coordIndex='0 1 2 3 4'><Coordinate point='0 0 0 2 0 0 2 2 0 "
        "1 0.5 0 0 2 0'/></IndexedFaceSet></Shape>");
    const auto points = points_of(scene, only_geometry(scene));
    float area = 0.0f;
    for (std::size_t i = 0; i < points.size(); i += 3) {
        const float part = glm::cross(points[i + 1] - points[i], points[i + 2] - points[i]).z;
        EXPECT_GE(part, 0.0f);
        area += part;
    }
    EXPECT_FLOAT_EQ(area, 2.0f * 2.5f);
}

// Two squares that meet at the z axis.
TEST(X3dFaceSets, CreaseAngle) {
    const std::string fold = "<Shape><IndexedFaceSet creaseAngle='";
    const std::string mesh =
        "' coordIndex='0 1 2 3 -1 1 4 5 2'><Coordinate point='-1 0 1, 0 0 1, 0 0 0, -1 0 0, "
        "0.5 -0.8660254 1, 0.5 -0.8660254 0'/></IndexedFaceSet></Shape>";
    // The faces' normals are 60 degrees apart.
    const ImportedScene sharp = read_x3d(fold + "1" + mesh), smooth = read_x3d(fold + "1.1" + mesh);
    const auto sharp_normals = values<glm::vec3>(sharp, only_geometry(sharp).normals);
    EXPECT_EQ(sharp_normals.size(), 8u) << "no vertex is shared";
    const auto smooth_normals = values<glm::vec3>(smooth, only_geometry(smooth).normals);
    ASSERT_EQ(smooth_normals.size(), 6u);
    const auto at_fold = values<glm::vec3>(smooth, only_geometry(smooth).positions);
    for (std::size_t i = 0; i < 6; ++i) {
        const glm::vec3 expected = at_fold[i].x < 0.0f   ? glm::vec3(0, 1, 0)
                                   : at_fold[i].x > 0.0f ? glm::vec3(0.8660254f, 0.5f, 0)
                                                         : glm::vec3(0.5f, 0.8660254f, 0);
        EXPECT_LT(glm::distance(smooth_normals[i], expected), 1e-6f);
    }
}

TEST(X3dFaceSets, EveryArrayHasItsOwnIndices) {
    const ImportedScene scene = read_textured(
        "<IndexedFaceSet coordIndex='0 1 2 -1 0 2 3' normalIndex='1 1 1 -1 0 0 0' texCoordIndex='3 2 1 -1 3 "
        "1 0' "
        "colorIndex='1 0' colorPerVertex='false'>" +
        std::string(Square) +
        "<Normal vector='0 0 1 0 1 0'/><TextureCoordinate point='0 0 0.25 0 0.5 0 0.75 1'/>"
        "<Color color='1 0 0 0 0 1'/></IndexedFaceSet>");
    const scene::Geometry& mesh = only_geometry(scene);
    const auto indices = values<std::uint32_t>(scene, mesh.indices);
    const auto normals = values<glm::vec3>(scene, mesh.normals);
    const auto coordinates = values<glm::vec2>(scene, mesh.tex_coords);
    const auto colors = values<glm::vec4>(scene, mesh.colors);
    ASSERT_EQ(indices.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(normals[indices[i]], i < 3 ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, 1));
        EXPECT_EQ(colors[indices[i]], i < 3 ? glm::vec4(0, 0, 1, 1) : glm::vec4(1, 0, 0, 1));
    }
    EXPECT_EQ(coordinates[indices[0]], glm::vec2(0.75f, 0.0f)) << "v turned down";
    EXPECT_EQ(coordinates[indices[2]], glm::vec2(0.25f, 1.0f));
    EXPECT_EQ(coordinates[indices[5]], glm::vec2(0.0f, 1.0f));
}

TEST(X3dFaceSets, ArraysWithoutIndicesFollowThePoints) {
    const ImportedScene scene = read_x3d(
        "<Shape><IndexedFaceSet coordIndex='3 2 1 -1 0 1 3' normalPerVertex='false'>" + std::string(Square) +
        "<Normal vector='1 0 0 0 1 0'/><ColorRGBA color='1 0 0 1 0 1 0 1 0 0 1 1 0 0 0 0.5'/>"
        "</IndexedFaceSet></Shape>");
    const scene::Geometry& mesh = only_geometry(scene);
    const auto indices = values<std::uint32_t>(scene, mesh.indices);
    EXPECT_EQ(values<glm::vec4>(scene, mesh.colors)[indices[0]], glm::vec4(0, 0, 0, 0.5f));
    EXPECT_EQ(values<glm::vec3>(scene, mesh.normals)[indices[0]], glm::vec3(1, 0, 0));
    EXPECT_EQ(values<glm::vec3>(scene, mesh.normals)[indices[5]], glm::vec3(0, 1, 0));
}

TEST(X3dFaceSets, TriangleSetsAreSmoothByDefault) {
    const std::string mesh =
        "index='0 1 2 0 2 3 1'><Coordinate point='0 0 0 1 0 0 0 1 0 0 0 1'/></IndexedTriangleSet></Shape>";
    const ImportedScene smooth = read_x3d("<Shape><IndexedTriangleSet " + mesh);
    EXPECT_EQ(smooth.counts.triangles, 2u) << "an index too many makes no triangle";
    EXPECT_EQ(values<glm::vec3>(smooth, only_geometry(smooth).positions).size(), 4u);
    EXPECT_EQ(values<glm::vec3>(smooth, only_geometry(smooth).normals).size(), 4u);
    const ImportedScene flat = read_x3d("<Shape><IndexedTriangleSet normalPerVertex='false' " + mesh);
    EXPECT_TRUE(only_geometry(flat).normals.empty());
}

TEST(X3dTextures, CoordinatesOfAMeshThatHasNone) {
    const ImportedScene scene = read_textured(
        "<IndexedFaceSet coordIndex='0 1 2 3'><Coordinate point="
        "'1 1 0, 1 5 0, 1 5 2, 1 1 2'/></IndexedFaceSet>");
    const auto coordinates = values<glm::vec2>(scene, only_geometry(scene).tex_coords);
    EXPECT_THAT(coordinates,
                ElementsAre(glm::vec2(0, 1), glm::vec2(1, 1), glm::vec2(1, 0.5f), glm::vec2(0, 0.5f)))
        << "s along y, t along z, v down";
}

TEST(X3dTextures, WrapAndTransform) {
    const ImportedScene scene = read_textured(
        "<IndexedFaceSet coordIndex='0 1 2'>" + std::string(Square) +
            "<TextureCoordinate point='0 0 1 0 1 1'/></IndexedFaceSet>",
        "<Appearance><Material/><ImageTexture DEF='i' url='t%20t.png' repeatS='false'/><TextureTransform "
        "center='1 0' rotation='1.5707963267948966' scale='2 3' translation='0.5 0'/></Appearance>");
    EXPECT_EQ(named<scene::Texture>(scene, "i").wrap_s, scene::Wrap::Clamp);
    EXPECT_EQ(named<scene::Texture>(scene, "i").wrap_t, scene::Wrap::Repeat);
    EXPECT_EQ(named<scene::Texture>(scene, "i").format, scene::TexelFormat::Rgba8Srgb);
    // -C S R C T of (0,0): (0.5,0) -> (1.5,0) -> (0,1.5) -> (0,4.5) -> (-1,4.5).
    const auto coordinates = values<glm::vec2>(scene, only_geometry(scene).tex_coords);
    EXPECT_LT(glm::distance(coordinates[0], glm::vec2(-1.0f, 1.0f - 4.5f)), 1e-5f);
}

TEST(X3dTextures, OneFileIsDecodedOnce) {
    const TestFolder folder;
    folder.write("t.png", png(2, 2, {200, 100, 50, 255}));
    const std::string shape =
        "<Shape><Appearance><Material/><ImageTexture url='\"t.png\"'/></Appearance><Box/></Shape>";
    const ImportedScene scene = loaded(folder.write("a.x3d", x3d(shape + shape)));
    expect_consistent(scene);
    EXPECT_EQ(scene.counts.textures, 2u) << "two nodes";
    EXPECT_EQ(all<scene::Texture>(scene)[0]->texels, all<scene::Texture>(scene)[1]->texels);
}

TEST(X3dTextures, AMissingImageIsAPlaceholder) {
    const ImportedScene scene = read_x3d(
        "<Shape><Appearance><Material DEF='brick'/><ImageTexture url='\"https://far.example/a.png\" "
        "\"b.png\"'/></Appearance><Box/></Shape>"
        "<Shape><Appearance DEF='sign'><ImageTexture url='\"b.png\"'/></Appearance><Box/></Shape>");
    for (const char* owner : {"<Material DEF='brick'>", "<Appearance DEF='sign'>"}) {
        EXPECT_TRUE(has_notice(
            scene, std::string("<ImageTexture> of ") + owner + " cannot be used (there is no file 'b.png'"));
    }
    EXPECT_EQ(scene.counts.placeholders, 2u);
    EXPECT_TRUE(
        has_notice(read_x3d("<Shape><Appearance><ImageTexture url='../a.png'/></Appearance><Box/></Shape>"),
                   "put the file into that folder"));
}

}  // namespace
}  // namespace tessera::import
