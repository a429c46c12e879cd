#include "client/import/closed_mesh.h"

#include <cmath>

#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

// Which meshes bound a volume.
namespace tessera::import {
namespace {

using scene::Geometry;
using scene::Material;

struct Soup {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices;
    MeshPart part() const { return {positions, indices}; }
};

// Vertices of its own for each triangle, as after flat shading.
void add_quad(Soup& soup, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d) {
    for (const glm::vec3& corner : {a, b, c, a, c, d}) {
        soup.indices.push_back(static_cast<std::uint32_t>(soup.positions.size()));
        soup.positions.push_back(corner);
    }
}

Soup box(float size, int faces) {
    Soup soup;
    const auto at = [&](int i) {
        return size * glm::vec3((i & 1) != 0 ? 1.0f : -1.0f, (i & 2) != 0 ? 1.0f : -1.0f,
                                (i & 4) != 0 ? 1.0f : -1.0f);
    };
    const int corners[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                               {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (int i = 0; i < faces; ++i)
        add_quad(soup, at(corners[i][0]), at(corners[i][1]), at(corners[i][2]), at(corners[i][3]));
    return soup;
}

double fraction(const Soup& soup) {
    const MeshPart parts[] = {soup.part()};
    return open_fraction(parts, 0);
}

TEST(ClosedMesh, BoxesAreClosedAtAnyScale) {
    for (const float size : {1e-15f, 1.0f, 1e15f}) {
        EXPECT_EQ(fraction(box(size, 6)), 0.0) << size;
        EXPECT_NEAR(fraction(box(size, 5)), 0.2, 1e-6) << size;
        EXPECT_NEAR(fraction(box(size, 1)), 1.0, 1e-6) << size;
    }
}

// A tube has two openings whose areas point in opposite directions.
TEST(ClosedMesh, TubesAreOpen) {
    EXPECT_NEAR(fraction(box(1.0f, 4)), 0.5, 1e-6);
}

// The lid of a box is another primitive of the mesh; a sheet that hangs in it closes nothing and opens nothing.
TEST(ClosedMesh, PartsCloseEachOther) {
    const Soup whole = box(1.0f, 6);
    Soup lid, rest, sheet;
    rest.positions = lid.positions = whole.positions;
    rest.indices.assign(whole.indices.begin(), whole.indices.end() - 6);
    lid.indices.assign(whole.indices.end() - 6, whole.indices.end());
    add_quad(sheet, {-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}, {-0.5f, 0.5f, 0});
    const MeshPart parts[] = {rest.part(), lid.part(), sheet.part()};
    EXPECT_EQ(open_fraction(parts, 0), 0.0);
    EXPECT_EQ(open_fraction(parts, 1), 0.0);
    EXPECT_NEAR(open_fraction(parts, 2), 1.0, 1e-6);
}

// Two quads meet one of twice their length: the edges differ, but there is no hole.
TEST(ClosedMesh, EdgesThatMeetHalfwayAreNoHole) {
    Soup soup = box(1.0f, 5);
    add_quad(soup, {-1, -1, 1}, {0, -1, 1}, {0, 1, 1}, {-1, 1, 1});
    add_quad(soup, {0, -1, 1}, {1, -1, 1}, {1, 1, 1}, {0, 1, 1});
    EXPECT_LT(fraction(soup), 1e-9);
}

TEST(ClosedMesh, DegenerateTrianglesCountForNothing) {
    Soup soup = box(1.0f, 6);
    for (const std::uint32_t i : {0u, 0u, 1u, 2u, 2u, 2u}) soup.indices.push_back(i);
    EXPECT_EQ(fraction(soup), 0.0);
    EXPECT_EQ(fraction(Soup{}), 0.0);
}

ImportedScene glass_of(const Soup& soup, const char* extensions, const ImportOptions& options = {}) {
    SceneFile file;
    const int at = file.positions(soup.positions);
    const int indices = file.indices(soup.indices);
    file.add("materials", std::string(R"({"name":"glass","extensions":{)") + extensions + "}}");
    file.add("meshes", R"({"name":"it","primitives":[{"attributes":{"POSITION":)" + std::to_string(at) +
                           R"(},"indices":)" + std::to_string(indices) + R"(,"material":0}]})");
    file.add("nodes", R"({"mesh":0})");
    file.add("scenes", R"({"nodes":[0]})");
    const TestFolder folder;
    ImportedScene scene = loaded(folder.write("scene.glb", file.glb()), options);
    expect_consistent(scene);
    return scene;
}

constexpr const char* Volume = R"("KHR_materials_transmission":{"transmissionFactor":1},
    "KHR_materials_volume":{"thicknessFactor":0.5,"attenuationDistance":0.25,"attenuationColor":[0.5,1,0.25]})";

// An open mesh with a volume is a thin wall that absorbs as its thickness would.
TEST(OpenVolume, IsThinWalled) {
    const ImportedScene pane = glass_of(box(1.0f, 1), Volume);
    EXPECT_TRUE(has_notice(pane, "mesh 'it' is open"));
    const Material& thin = object<Material>(pane, named<Geometry>(pane, "it").material);
    EXPECT_EQ(thin.thickness, 0.0f);
    EXPECT_EQ(thin.base_color, glm::vec4(0.25f, 1.0f, 0.0625f, 1.0f));
    EXPECT_EQ(thin.attenuation_distance, 0.0f);
    const ImportedScene solid = glass_of(box(1.0f, 6), Volume);
    EXPECT_FALSE(has_notice(solid, "is open"));
    EXPECT_EQ(object<Material>(solid, named<Geometry>(solid, "it").material).thickness, 0.5f);
}

TEST(OpenVolume, IsSolidIfTheUserSaysSo) {
    const ImportedScene pane = glass_of(
        box(1.0f, 1), R"("KHR_materials_transmission":{"transmissionFactor":1})", {.glass = Glass::Solid});
    EXPECT_FALSE(has_notice(pane, "is open"));
    EXPECT_GT(object<Material>(pane, named<Geometry>(pane, "it").material).thickness, 0.0f);
}

}  // namespace
}  // namespace tessera::import
