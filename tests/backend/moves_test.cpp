// An instance that moves costs its own place; the tables are those that are made anew.
#include <gtest/gtest.h>

#include <cstring>

#include "tests/backend/tables_stage.h"

namespace tessera::backend {
namespace {

using scene::Create;
using test::moved;
using test::SceneBuilder;
using test::transform;

constexpr ObjectId MeshId{2}, LampId{3}, GlowId{4}, NearId{5}, FarId{6}, LitId{7}, SunId{8}, GlassId{9};

struct MovesTest : testing::Test, test::TablesStage {
    MovesTest() {
        const std::vector<std::uint32_t> indices{0, 1, 2};
        const std::vector<glm::vec3> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        const scene::Geometry mesh{.indices = blob(indices), .positions = blob(positions)};
        scene::Geometry lamp = mesh;
        lamp.material = GlowId;
        edit({Create{MeshId, mesh}, Create{LampId, lamp},
              Create{GlowId, scene::Material{.emission = glm::vec3(1.0f)}},
              Create{NearId, transform(moved(1, 0, 0), {MeshId})},
              Create{FarId, transform(moved(9, 0, 0), {MeshId})},
              Create{LitId, transform(moved(2, 0, 0), {LampId})},
              Create{scene::RootId, scene::Root{.children = {NearId, FarId, LitId}}}});
    }

    TablesStep edit(std::vector<scene::Entry> entries) { return take(builder.edit(std::move(entries))); }
    TablesStep move(ObjectId id, const glm::dmat4& to) { return take(builder.move(id, to)); }

    TablesStep take(const scene::ChangeList& list) {
        EXPECT_TRUE(shadow.apply(list));
        const SceneDelta delta = shadow.take_delta();
        meshes.update(shadow.scene(), delta);
        const TablesStep step =
            update_tables(tables, shadow.scene(), shadow.lowered(), meshes, *blobs, pyramids, delta);
        expect_as_made_anew();
        return step;
    }

    void expect_as_made_anew() {
        const SceneTables fresh = make_all();
        EXPECT_TRUE(same_bytes(tables.instances, fresh.instances));
        EXPECT_TRUE(same_bytes(tables.lights, fresh.lights));
        EXPECT_TRUE(same_bytes(tables.emitters, fresh.emitters));
        EXPECT_TRUE(same_bytes(tables.light_nodes, fresh.light_nodes));
        EXPECT_EQ(tables.sums, fresh.sums);
        EXPECT_EQ(tables.scene.features, fresh.scene.features);
    }
    template <class T>
    static bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
        return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
    }

    SceneTables tables;
};

TEST_F(MovesTest, WhatDoesNotShineGetsAPlaceAndNoMore) {
    EXPECT_EQ(move(NearId, moved(1, 2, 3)), TablesStep::Moved);
    EXPECT_EQ(move(FarId, moved(20, 2, 3)), TablesStep::Moved);
    EXPECT_EQ(move(NearId, glm::scale(moved(1, 2, 3), glm::dvec3(-1.0, 2.0, 0.0))), TablesStep::Moved);
}

TEST_F(MovesTest, ALampTakesItsEmittersWithIt) {
    EXPECT_EQ(move(LitId, moved(1, 2, 3)), TablesStep::Made);
}

TEST_F(MovesTest, LightFromInfinitelyFarGrowsWithTheScene) {
    const scene::Light sun{.kind = scene::LightKind::Directional};
    EXPECT_EQ(edit({Create{SunId, sun}, SceneBuilder::update<scene::Root>(
                                            scene::RootId, &scene::Root::children,
                                            scene::Root{.children = {NearId, FarId, LitId, SunId}})}),
              TablesStep::Made);
    EXPECT_EQ(move(NearId, moved(2, 0, 0)), TablesStep::Made);    // it was at the scene's rim
    EXPECT_EQ(move(NearId, moved(3, 0, 0)), TablesStep::Moved);   // inside, where the lamp is the rim now
    EXPECT_EQ(move(NearId, moved(3, 0, 0.5)), TablesStep::Made);  // beyond the rim
    EXPECT_EQ(move(FarId, moved(8, 0, 0)), TablesStep::Made);
}

// Bodies of glass know of each other as soon as one may lie in another.
TEST_F(MovesTest, GlassThatComesIntoGlassIsNoted) {
    const auto nests = [&] { return (tables.scene.features & shading::FeatureNestedGlass) != 0; };
    edit({Create{GlassId, scene::Material{.transmission = 1.0f, .thickness = 1.0f}},
          SceneBuilder::update<scene::Geometry>(MeshId, &scene::Geometry::material,
                                                scene::Geometry{.material = GlassId})});
    EXPECT_FALSE(nests());
    EXPECT_EQ(move(NearId, moved(2, 0, 0)), TablesStep::Moved);
    EXPECT_EQ(move(NearId, moved(8.5, 0, 0)), TablesStep::Made);
    EXPECT_TRUE(nests());
    EXPECT_EQ(move(NearId, moved(8.4, 0, 0)), TablesStep::Moved);
    EXPECT_EQ(move(NearId, moved(8.4, 0, 0.1)), TablesStep::Made);
    EXPECT_FALSE(nests());
}

TEST_F(MovesTest, WhatMovesInTheShutterHasPlacesOfItsOwn) {
    scene::Transform swings = transform(moved(1, 0, 0), {});
    swings.motion = {moved(2, 0, 0)};
    EXPECT_EQ(edit({SceneBuilder::update<scene::Transform>(NearId, &scene::Transform::motion, swings)}),
              TablesStep::Made);
    EXPECT_EQ(move(NearId, moved(0, 0, 0)), TablesStep::Made);
    EXPECT_EQ(move(FarId, moved(7, 0, 0)), TablesStep::Moved);
}

TEST_F(MovesTest, AnEditOfAMaterialIsNoMove) {
    EXPECT_EQ(edit({SceneBuilder::update<scene::Material>(GlowId, &scene::Material::emission,
                                                          scene::Material{.emission = glm::vec3(3.0f)})}),
              TablesStep::Made);
}

}  // namespace
}  // namespace tessera::backend
