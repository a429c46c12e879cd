// Moving an instance updates only its record; the tables equal rebuilt ones.
#include <gtest/gtest.h>

#include <cstring>

#include "tests/backend/tables_fixture.h"

namespace tessera::backend {
namespace {

using scene::Create;
using test::moved;
using test::SceneBuilder;
using test::transform;

constexpr ObjectId MeshId{2}, LampId{3}, EmissiveId{4}, NearId{5}, FarId{6}, LitId{7}, SunId{8}, GlassId{9};

struct UpdateTablesTest : testing::Test, test::TablesFixture {
    UpdateTablesTest() {
        const std::vector<std::uint32_t> indices{0, 1, 2};
        const std::vector<glm::vec3> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        const scene::Geometry mesh{.indices = blob(indices), .positions = blob(positions)};
        scene::Geometry lamp = mesh;
        lamp.material = EmissiveId;
        edit({Create{MeshId, mesh}, Create{LampId, lamp},
              Create{EmissiveId, scene::Material{.emission = glm::vec3(1.0f)}},
              Create{NearId, transform(moved(1, 0, 0), {MeshId})},
              Create{FarId, transform(moved(9, 0, 0), {MeshId})},
              Create{LitId, transform(moved(2, 0, 0), {LampId})},
              Create{scene::RootId, scene::Root{.children = {NearId, FarId, LitId}}}});
    }

    TablesUpdate edit(std::vector<scene::Entry> entries) { return take(builder.edit(std::move(entries))); }
    TablesUpdate move(ObjectId id, const glm::dmat4& to) { return take(builder.move(id, to)); }

    TablesUpdate take(const scene::ChangeList& list) {
        EXPECT_TRUE(shadow.apply(list));
        const SceneDelta delta = shadow.take_delta();
        meshes.update(shadow.scene(), delta);
        const TablesUpdate step =
            update_tables(tables, shadow.scene(), shadow.flat_scene(), meshes, *blobs, mipmaps, delta);
        expect_as_made_anew();
        return step;
    }

    void expect_as_made_anew() {
        const SceneTables fresh = make_all();
        EXPECT_TRUE(same_bytes(tables.instances, fresh.instances));
        EXPECT_TRUE(same_bytes(tables.lights, fresh.lights));
        EXPECT_TRUE(same_bytes(tables.emitters, fresh.emitters));
        EXPECT_TRUE(same_bytes(tables.light_nodes, fresh.light_nodes));
        EXPECT_EQ(tables.cdfs, fresh.cdfs);
        EXPECT_EQ(tables.scene.features, fresh.scene.features);
    }
    template <class T>
    static bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
        return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
    }

    SceneTables tables;
};

TEST_F(UpdateTablesTest, MovesOnlyTheTransformOfNonEmissiveInstances) {
    EXPECT_EQ(move(NearId, moved(1, 2, 3)), TablesUpdate::Moved);
    EXPECT_EQ(move(FarId, moved(20, 2, 3)), TablesUpdate::Moved);
    EXPECT_EQ(move(NearId, glm::scale(moved(1, 2, 3), glm::dvec3(-1.0, 2.0, 0.0))), TablesUpdate::Moved);
}

TEST_F(UpdateTablesTest, AMovedLampUpdatesItsEmitters) {
    EXPECT_EQ(move(LitId, moved(1, 2, 3)), TablesUpdate::Rebuilt);
}

TEST_F(UpdateTablesTest, InfiniteLightsDoNotDependOnTheSizeOfTheScene) {
    const scene::Light sun{.kind = scene::LightKind::Directional};
    EXPECT_EQ(edit({Create{SunId, sun}, SceneBuilder::update<scene::Root>(
                                            scene::RootId, &scene::Root::children,
                                            scene::Root{.children = {NearId, FarId, LitId, SunId}})}),
              TablesUpdate::Rebuilt);
    EXPECT_EQ(move(NearId, moved(2, 0, 0)), TablesUpdate::Moved);
    EXPECT_EQ(move(FarId, moved(800, 0, 0)), TablesUpdate::Moved);
}

// Glass objects count as nested as soon as their bounds overlap.
TEST_F(UpdateTablesTest, GlassMovedIntoGlassIsDetected) {
    const auto nests = [&] { return (tables.scene.features & shading::FeatureNestedGlass) != 0; };
    edit({Create{GlassId, scene::Material{.transmission = 1.0f, .thickness = 1.0f}},
          SceneBuilder::update<scene::Geometry>(MeshId, &scene::Geometry::material,
                                                scene::Geometry{.material = GlassId})});
    EXPECT_FALSE(nests());
    EXPECT_EQ(move(NearId, moved(2, 0, 0)), TablesUpdate::Moved);
    EXPECT_EQ(move(NearId, moved(8.5, 0, 0)), TablesUpdate::Rebuilt);
    EXPECT_TRUE(nests());
    EXPECT_EQ(move(NearId, moved(8.4, 0, 0)), TablesUpdate::Moved);
    EXPECT_EQ(move(NearId, moved(8.4, 0, 0.1)), TablesUpdate::Rebuilt);
    EXPECT_FALSE(nests());
}

TEST_F(UpdateTablesTest, MovingInstancesHaveTheirOwnMotionKeys) {
    scene::Transform swings = transform(moved(1, 0, 0), {});
    swings.motion = {moved(2, 0, 0)};
    EXPECT_EQ(edit({SceneBuilder::update<scene::Transform>(NearId, &scene::Transform::motion, swings)}),
              TablesUpdate::Rebuilt);
    EXPECT_EQ(move(NearId, moved(0, 0, 0)), TablesUpdate::Rebuilt);
    EXPECT_EQ(move(FarId, moved(7, 0, 0)), TablesUpdate::Moved);
}

TEST_F(UpdateTablesTest, AnEditOfAMaterialRebuildsTheTables) {
    EXPECT_EQ(edit({SceneBuilder::update<scene::Material>(EmissiveId, &scene::Material::emission,
                                                          scene::Material{.emission = glm::vec3(3.0f)})}),
              TablesUpdate::Rebuilt);
}

}  // namespace
}  // namespace tessera::backend
