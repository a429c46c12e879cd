// How an edit affects each mesh's acceleration structure.
#include "mediator/backend/tables/meshes.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/backend/scene_builder.h"

namespace tessera::backend {
namespace {

using scene::Create;
using scene::Geometry;
using test::SceneBuilder;

constexpr ObjectId Shape{2};

struct MeshesTest : testing::Test {
    scene::BlobRef triangles(const std::vector<std::uint32_t>& indices) {
        return scene::reference(*blobs->insert(std::as_bytes(std::span(indices))));
    }
    scene::BlobRef points(const std::vector<glm::vec3>& positions) {
        return scene::reference(*blobs->insert(std::as_bytes(std::span(positions))));
    }
    MeshCatalog::Result edit(std::vector<scene::Entry> entries) {
        EXPECT_TRUE(shadow.apply(builder.edit(std::move(entries))));
        return meshes.update(shadow.scene(), shadow.take_delta());
    }
    MeshCatalog::Result create(scene::MotionHint hint) {
        return edit({Create{scene::RootId, scene::Root{.children = {Shape}}},
                     Create{Shape, Geometry{.hint = hint,
                                            .indices = triangles({0, 1, 2, 0, 0, 1}),
                                            .positions = points({{0, 0, 0}, {1, 0, 0}, {0, 2, 0}})}}});
    }
    MeshUpdate step_of(scene::Fields<Geometry> fields, const Geometry& geometry) {
        const MeshCatalog::Result result = edit({SceneBuilder::update<Geometry>(Shape, fields, geometry)});
        EXPECT_EQ(result.changes.size(), 1u);
        return result.changes.at(0).step;
    }

    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    MeshCatalog meshes{blobs};
    SceneBuilder builder;
    ShadowScene shadow;
};

TEST_F(MeshesTest, ANewMeshIsBuiltAndMeasured) {
    const MeshCatalog::Result result = create(scene::MotionHint::Static);
    ASSERT_EQ(result.changes.size(), 1u);
    EXPECT_EQ(result.changes[0].step, MeshUpdate::Rebuild);
    EXPECT_EQ(result.count(MeshUpdate::Rebuild), 1u);
    EXPECT_EQ(result.count(MeshUpdate::Refit), 0u);
    const Mesh& mesh = *meshes.find(Shape);
    EXPECT_EQ(mesh.degenerate_triangles, 1u);
    EXPECT_EQ(mesh.low, glm::vec3(0.0f));
    EXPECT_EQ(mesh.high, glm::vec3(1.0f, 2.0f, 0.0f));
    EXPECT_EQ(elements<glm::vec3>(mesh.positions).size(), 3u);
    EXPECT_TRUE(elements<glm::vec3>(mesh.normals).empty());
}

TEST_F(MeshesTest, OtherShadingDataNeedNoRebuild) {
    create(scene::MotionHint::Static);
    const Geometry other{.normals = points({{0, 0, 1}, {0, 0, 1}, {0, 0, 1}})};
    EXPECT_EQ(step_of(&Geometry::normals, other), MeshUpdate::ShadingData);
    EXPECT_EQ(elements<glm::vec3>(meshes.find(Shape)->normals).size(), 3u);
}

TEST_F(MeshesTest, MovedVerticesRefitAnimatedMeshesAndRebuildOthers) {
    const Geometry moved{.positions = points({{0, 0, 0}, {9, 0, 0}, {0, 2, 0}})};
    create(scene::MotionHint::Animated);
    EXPECT_EQ(step_of(&Geometry::positions, moved), MeshUpdate::Refit);
    EXPECT_EQ(meshes.find(Shape)->high.x, 9.0f);
    const Geometry more{.positions = points({{0, 0, 0}, {9, 0, 0}, {0, 2, 0}, {1, 1, 1}})};
    EXPECT_EQ(step_of(&Geometry::positions, more), MeshUpdate::Rebuild);
    EXPECT_EQ(step_of(&Geometry::hint, Geometry{.hint = scene::MotionHint::Static}), MeshUpdate::Rebuild);
    EXPECT_EQ(step_of(&Geometry::positions, moved), MeshUpdate::Rebuild);
}

TEST_F(MeshesTest, InvalidMeshesHaveAPlaceholderUntilTheyAreValid) {
    create(scene::MotionHint::Animated);
    const MeshCatalog::Result broken =
        edit({SceneBuilder::update<Geometry>(Shape, &Geometry::indices, {.indices = triangles({0, 1, 7})})});
    EXPECT_EQ(broken.problems.size(), 1u);
    EXPECT_EQ(broken.count(MeshUpdate::Rebuild), 1u);
    EXPECT_TRUE(meshes.find(Shape)->placeholder);
    EXPECT_EQ(meshes.find(Shape)->high, glm::vec3(0.5f));
    EXPECT_EQ(elements<glm::uvec3>(meshes.find(Shape)->triangles).size(), 12u);
    EXPECT_EQ(step_of(&Geometry::indices, {.indices = triangles({0, 1, 2})}), MeshUpdate::Rebuild);
    EXPECT_FALSE(meshes.find(Shape)->placeholder);
}

TEST_F(MeshesTest, ARemovedMeshIsErased) {
    create(scene::MotionHint::Static);
    const MeshCatalog::Result result = edit(
        {SceneBuilder::update<scene::Root>(scene::RootId, &scene::Root::children, {}), scene::Remove{Shape}});
    EXPECT_EQ(result.removed, std::vector{Shape});
    EXPECT_EQ(meshes.find(Shape), nullptr);
}

}  // namespace
}  // namespace tessera::backend
