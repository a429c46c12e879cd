#include "mediator/view/placed_cameras.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "mediator/scene/fields.h"
#include "mediator/view/camera_scene.h"

namespace tessera::view {
namespace {

using namespace scene;

glm::dmat4 moved(double x) {
    return glm::translate(glm::dmat4(1.0), glm::dvec3(x, 0, 0));
}

Transform at(double x, std::vector<ObjectId> children) {
    Transform transform{.children = std::move(children)};
    transform.matrix = moved(x);
    return transform;
}

Update matrix_of(ObjectId id, const glm::dmat4& matrix) {
    Transform transform;
    transform.matrix = matrix;
    return {id, Fields<Transform>(&Transform::matrix).bits(), transform};
}

Update children_of(ObjectId id, std::vector<ObjectId> children) {
    return {id, Fields<Transform>(&Transform::children).bits(), Transform{.children = std::move(children)}};
}

Scene scene_of(std::vector<Entry> entries, std::vector<ObjectId> top) {
    Scene scene;
    entries.emplace_back(Create{RootId, Root{.children = std::move(top)}});
    EXPECT_TRUE(scene.apply_entries(entries));
    return scene;
}

constexpr ObjectId A{10}, B{11}, C{12}, Front{20}, Side{21}, Loose{22};

// Root: A (Front, B (Side)), and C without a camera.
Scene two_cameras() {
    return scene_of({Create{A, at(1, {Front, B})}, Create{B, at(2, {Side})}, Create{C, at(4, {})},
                     Create{Front, Camera{.name = "front"}}, Create{Side, Camera{.name = "side"}},
                     Create{Loose, Camera{.name = "loose"}}},
                    {A, C});
}

TEST(PlacedCameras, AreListedDepthFirstAtTheirFirstInstance) {
    Scene scene = two_cameras();
    ASSERT_TRUE(scene.apply_entries({children_of(C, {Front, B, Side})}));
    const auto cameras = placed_cameras(scene);
    ASSERT_EQ(cameras.size(), 2u);
    EXPECT_EQ(cameras[0].name, "front");
    EXPECT_EQ(cameras[0].world_from_camera, moved(1));
    EXPECT_EQ(cameras[1].name, "side");
    EXPECT_EQ(cameras[1].world_from_camera, moved(3));
}

TEST(PlacedCameras, CamerasWithSingularTransformsAreRejected) {
    Scene scene = two_cameras();
    ASSERT_TRUE(scene.apply_entries({matrix_of(B, glm::scale(glm::dmat4(1.0), {1, 1, 0}))}));
    EXPECT_TRUE(choose_camera(scene, ""));
    ASSERT_FALSE(choose_camera(scene, "side"));
    EXPECT_NE(std::string(choose_camera(scene, "side").error().what()).find("'side' has no valid direction"),
              std::string::npos);
    glm::dmat4 far = glm::scale(glm::dmat4(1.0), glm::dvec3(1e200));
    ASSERT_TRUE(scene.apply_entries({matrix_of(A, far), matrix_of(B, moved(1e10))}));
    EXPECT_FALSE(choose_camera(scene, "side"));
}

// A recursion would overflow the stack.
TEST(PlacedCameras, WorkBelowDeepChains) {
    constexpr std::uint64_t Depth = 200'000, First = 1000;
    std::vector<Entry> chain{Create{Front, Camera{.name = "deep"}}};
    for (std::uint64_t i = 0; i < Depth; ++i)
        chain.emplace_back(
            Create{ObjectId{First + i}, at(1, {i + 1 < Depth ? ObjectId{First + i + 1} : Front})});
    const Scene scene = scene_of(std::move(chain), {ObjectId{First}});
    const auto camera = choose_camera(scene, "");
    ASSERT_TRUE(camera);
    EXPECT_EQ(camera->world_from_camera, moved(Depth));
}

// 2^64 instances, far too many to visit one by one.
TEST(PlacedCameras, WorkInAGraphWithExponentialSharing) {
    constexpr std::uint64_t Levels = 64, First = 1000;
    std::vector<Entry> levels{Create{Front, Camera{.name = "many"}}};
    for (std::uint64_t i = 0; i < Levels; ++i) {
        const ObjectId below = i + 1 < Levels ? ObjectId{First + i + 1} : Front;
        levels.emplace_back(Create{ObjectId{First + i}, at(1, {below, below})});
    }
    const auto cameras = placed_cameras(scene_of(std::move(levels), {ObjectId{First}}));
    ASSERT_EQ(cameras.size(), 1u);
    EXPECT_EQ(cameras[0].world_from_camera, moved(Levels));
}

struct Followed : testing::Test {
    Scene scene = two_cameras();
    FollowedCamera camera{scene, "side"};

    bool follow(std::vector<Entry> entries) {
        EXPECT_TRUE(scene.apply_entries(entries));
        const bool changed = camera.follow({.from = {1, 1}, .to = {1, 2}, .entries = entries}, scene);
        const auto expected = choose_camera(scene, "side");
        EXPECT_EQ(camera.world_from_camera().has_value(), expected.has_value());
        if (expected && camera.world_from_camera()) {
            EXPECT_EQ(*camera.world_from_camera(), expected->world_from_camera);
        }
        return changed;
    }
};

TEST_F(Followed, MovesWithTheTransformsAboveIt) {
    EXPECT_EQ(*camera.world_from_camera(), moved(3));
    EXPECT_TRUE(follow({matrix_of(A, moved(5))}));
    EXPECT_TRUE(follow({matrix_of(B, glm::scale(moved(-1), glm::dvec3(3)))}));
    EXPECT_FALSE(follow({matrix_of(C, moved(9))})) << "it is not above";
    EXPECT_FALSE(follow({matrix_of(A, moved(5))})) << "where it is";
}

TEST_F(Followed, FollowsChangesOfTheGraph) {
    EXPECT_TRUE(follow({children_of(A, {Front}), children_of(C, {B})}));
    EXPECT_TRUE(follow({matrix_of(C, moved(8))}));
    EXPECT_FALSE(follow({matrix_of(A, moved(8))})) << "it was taken from there";
    EXPECT_FALSE(follow({Create{ObjectId{30}, at(1, {Side})}})) << "placed nowhere itself";
    EXPECT_FALSE(follow({children_of(A, {Front, Loose})})) << "another camera";
    EXPECT_TRUE(follow({Update{RootId, Fields<Root>(&Root::children).bits(), Root{.children = {A}}}}));
    EXPECT_FALSE(camera.world_from_camera()) << "gone";
    EXPECT_TRUE(follow({children_of(A, {Front, Side})}));
    EXPECT_TRUE(
        follow({children_of(A, {Front}), children_of(B, {}), children_of(ObjectId{30}, {}), Remove{Side}}));
}

TEST_F(Followed, FollowsChangesOfNames) {
    const auto renamed = [](ObjectId id, const std::string& name) {
        return Update{id, Fields<Camera>(&Camera::name).bits(), Camera{.name = name}};
    };
    EXPECT_TRUE(follow({renamed(Side, "back")}));
    EXPECT_FALSE(camera.world_from_camera());
    EXPECT_TRUE(follow({renamed(Front, "side")}));
    EXPECT_EQ(*camera.world_from_camera(), moved(1));
}

TEST_F(Followed, HandlesAnObjectOfAnotherKindWithTheSameId) {
    EXPECT_TRUE(follow({Remove{B}, Create{B, Attachment{}}}));
    EXPECT_FALSE(camera.world_from_camera());
    EXPECT_TRUE(follow({Remove{B}, Create{B, Camera{.name = "side"}}}));
    EXPECT_EQ(*camera.world_from_camera(), moved(1));
}

TEST_F(Followed, RecoversFromASingularTransform) {
    EXPECT_TRUE(follow({matrix_of(A, glm::scale(glm::dmat4(1.0), glm::dvec3(0)))}));
    EXPECT_FALSE(camera.world_from_camera());
    EXPECT_FALSE(follow({matrix_of(A, glm::scale(glm::dmat4(1.0), glm::dvec3(0, 1, 0)))}));
    EXPECT_TRUE(follow({matrix_of(A, moved(5))}));
}

// What viewers read: as deep as a graph may be, with shared parts, and nothing else of it.
TEST(CameraScene, HasTheCamerasAtTheirPlacesAndNothingElse) {
    constexpr std::uint64_t Depth = 100'000, Eye = 2'000'000, Mesh = 2'000'001, Spare = 2'000'002;
    std::vector<Entry> entries{Create{ObjectId{Eye}, Camera{.name = "eye"}},
                               Create{ObjectId{Mesh}, Geometry{}},
                               Create{ObjectId{Spare}, at(5, {ObjectId{Mesh}})}};
    for (std::uint64_t i = 0; i < Depth; ++i) {
        const ObjectId below{i + 1 < Depth ? 101 + i : Eye};
        entries.emplace_back(Create{ObjectId{100 + i}, at(1, {ObjectId{Mesh}, below})});
    }
    entries.emplace_back(Create{ObjectId{50}, at(-3, {ObjectId{100 + Depth - 1}})});
    Scene whole = scene_of(std::move(entries), {ObjectId{Spare}, ObjectId{100}, ObjectId{50}});
    whole.set_version({7, 3});
    const Scene cameras = camera_scene(whole);
    EXPECT_EQ(cameras.version(), whole.version());
    EXPECT_EQ(cameras.objects().size(), Depth + 3) << "the chain, its second parent, the camera and the root";
    EXPECT_EQ(cameras.find(ObjectId{Mesh}), nullptr);
    EXPECT_EQ(cameras.find(ObjectId{Spare}), nullptr);
    const auto expected = placed_cameras(whole), seen = placed_cameras(cameras);
    ASSERT_EQ(seen.size(), expected.size());
    ASSERT_FALSE(seen.empty());
    EXPECT_EQ(seen[0].world_from_camera, expected[0].world_from_camera);
    EXPECT_EQ(camera_scene(Scene{}).objects().size(), 0u);
}

}  // namespace
}  // namespace tessera::view
