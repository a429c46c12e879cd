#include "mediator/backend/flattening.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>

#include "tests/backend/scene_builder.h"

namespace tessera::backend {
namespace {

using scene::Create;
using scene::MotionHint;
using test::moved;
using test::transform;

std::vector<scene::Entry> two_copies() {
    return {Create{scene::RootId, scene::Root{.name = {}, .children = {ObjectId{10}, ObjectId{11}}}},
            Create{ObjectId{10}, transform(moved(1, 0, 0), {ObjectId{12}})},
            Create{ObjectId{11}, transform(moved(0, 2, 0), {ObjectId{12}, ObjectId{30}})},
            Create{ObjectId{12}, transform(moved(0, 0, 3), {ObjectId{20}})},
            Create{ObjectId{20}, scene::Geometry{}},
            Create{ObjectId{30}, scene::Light{}}};
}

scene::Scene scene_with(const std::vector<scene::Entry>& entries) {
    test::SceneBuilder builder;
    builder.edit(entries);
    return builder.scene();
}

TEST(Flattening, KeepsSharingAndMultipliesNestedTransforms) {
    const Expected<FlatScene> flat_scene = flatten(scene_with(two_copies()));
    ASSERT_TRUE(flat_scene);
    ASSERT_EQ(flat_scene->instances.size(), 2u);
    EXPECT_EQ(flat_scene->instances[0].geometry, ObjectId{20});
    EXPECT_EQ(flat_scene->instances[0].path, (std::vector{ObjectId{10}, ObjectId{12}}));
    EXPECT_EQ(flat_scene->instances[0].world_from_object, moved(1, 0, 3));
    EXPECT_EQ(flat_scene->instances[1].world_from_object, moved(0, 2, 3));
    ASSERT_EQ(flat_scene->lights.size(), 1u);
    EXPECT_EQ(flat_scene->lights[0].world_from_light, moved(0, 2, 0));
}

std::vector<scene::Entry> moving_copies(const std::vector<glm::dmat4>& outer,
                                        const std::vector<glm::dmat4>& inner) {
    std::vector<scene::Entry> entries = two_copies();
    std::get<scene::Transform>(std::get<Create>(entries[1]).object).motion = outer;
    std::get<scene::Transform>(std::get<Create>(entries[3]).object).motion = inner;
    return entries;
}

TEST(Flattening, ASingleMovingTransformKeepsItsMotionKeys) {
    const Expected<FlatScene> flat_scene =
        flatten(scene_with(moving_copies({moved(2, 0, 0), moved(5, 0, 0)}, {})));
    ASSERT_TRUE(flat_scene);
    EXPECT_EQ(flat_scene->instances[0].motion, (std::vector{moved(2, 0, 3), moved(5, 0, 3)}));
    EXPECT_TRUE(flat_scene->instances[1].motion.empty()) << "it is not below";
    EXPECT_TRUE(flat_scene->lights[0].motion.empty());
}

TEST(Flattening, MotionKeysOfSeveralMovingTransformsCoincide) {
    const std::vector<glm::dmat4> outer{moved(2, 0, 0), moved(3, 0, 0)},
        inner{moved(0, 1, 3), moved(0, 5, 3), moved(0, 6, 3)};
    const Expected<FlatScene> flat_scene = flatten(scene_with(moving_copies(outer, inner)));
    ASSERT_TRUE(flat_scene);
    // Twelve keys, since products are not linear between six; the first moves from 1 by 2 and 3, the other from 0 by
    // 1, 5 and 6.
    const std::vector<glm::dmat4>& motion = flat_scene->instances[0].motion;
    ASSERT_EQ(motion.size(), 12u);
    EXPECT_LT(glm::distance(motion[5][3], moved(2, 3, 3)[3]), 1e-12);
    EXPECT_LT(glm::distance(motion[3][3], glm::dvec4(1.0 + 2.0 / 3.0, 1, 3, 1)), 1e-12);
    EXPECT_LT(glm::distance(motion[11][3], moved(3, 6, 3)[3]), 1e-12);
    EXPECT_EQ(flat_scene->instances[1].motion, (std::vector{moved(0, 3, 3), moved(0, 7, 3), moved(0, 8, 3)}));
}

TEST(Flattening, EqualMotionKeysAreNoMotion) {
    const Expected<FlatScene> flat_scene =
        flatten(scene_with(moving_copies({moved(1, 0, 0), moved(1, 0, 0)}, {})));
    ASSERT_TRUE(flat_scene);
    EXPECT_TRUE(flat_scene->instances[0].motion.empty());
}

TEST(Flattening, DoesNotDependOnTheOrderOfCreation) {
    std::vector<scene::Entry> entries = two_copies();
    const Expected<FlatScene> forward = flatten(scene_with(entries));
    std::reverse(entries.begin(), entries.end());
    auto& root = std::get<scene::Root>(std::get<Create>(entries.back()).object);
    std::reverse(root.children.begin(), root.children.end());
    const Expected<FlatScene> backward = flatten(scene_with(entries));
    ASSERT_TRUE(forward && backward);
    ASSERT_EQ(forward->instances.size(), backward->instances.size());
    for (std::size_t i = 0; i < forward->instances.size(); ++i) {
        EXPECT_EQ(forward->instances[i].path, backward->instances[i].path);
        EXPECT_EQ(forward->instances[i].world_from_object, backward->instances[i].world_from_object);
    }
}

TEST(Flattening, ACycleIsAnErrorThatNamesATransform) {
    const Expected<FlatScene> flat_scene =
        flatten(scene_with({Create{scene::RootId, scene::Root{.name = {}, .children = {ObjectId{10}}}},
                            Create{ObjectId{10}, transform(moved(1, 0, 0), {ObjectId{11}})},
                            Create{ObjectId{11}, transform(moved(1, 0, 0), {ObjectId{10}})}}));
    ASSERT_FALSE(flat_scene);
    EXPECT_EQ(flat_scene.error().code(), ErrorCode::InvalidInput);
    EXPECT_NE(std::string(flat_scene.error().what()).find("contains itself"), std::string::npos);
}

TEST(Flattening, ExponentialSharingIsRejectedAtOnce) {
    std::vector<scene::Entry> entries{
        Create{scene::RootId, scene::Root{.name = {}, .children = {ObjectId{100}}}},
        Create{ObjectId{20}, scene::Geometry{}}};
    constexpr std::uint64_t Levels = 60;
    for (std::uint64_t i = 0; i < Levels; ++i) {
        const bool last = i + 1 == Levels;
        const ObjectId below = last ? ObjectId{20} : ObjectId{100 + 2 * (i + 1)};
        const ObjectId other = last ? ObjectId{20} : ObjectId{101 + 2 * (i + 1)};
        for (const std::uint64_t id : {100 + 2 * i, 101 + 2 * i}) {
            entries.push_back(Create{ObjectId{id}, transform(glm::dmat4(1.0), {below, other})});
        }
    }
    const Expected<FlatScene> flat_scene = flatten(scene_with(entries));
    ASSERT_FALSE(flat_scene);
    EXPECT_EQ(flat_scene.error().code(), ErrorCode::InvalidInput);

    // The same graph without a geometry is cheap.
    entries[1] = Create{ObjectId{20}, scene::Camera{}};
    const Expected<FlatScene> empty = flatten(scene_with(entries));
    ASSERT_TRUE(empty);
    EXPECT_TRUE(empty->instances.empty());
}

TEST(Flattening, AChainThatIsTooDeepIsRejected) {
    std::vector<scene::Entry> entries{
        Create{scene::RootId, scene::Root{.name = {}, .children = {ObjectId{100}}}},
        Create{ObjectId{20}, scene::Geometry{}}};
    const auto chain = [&](std::uint64_t depth) {
        std::vector<scene::Entry> result = entries;
        for (std::uint64_t i = 0; i < depth; ++i) {
            const ObjectId child = i + 1 == depth ? ObjectId{20} : ObjectId{101 + i};
            result.push_back(Create{ObjectId{100 + i}, transform(glm::dmat4(1.0), {child})});
        }
        return flatten(scene_with(result));
    };
    EXPECT_TRUE(chain(scene::MaxDepth));
    EXPECT_FALSE(chain(scene::MaxDepth + 1));
    EXPECT_FALSE(chain(50'000));
}

TEST(Flattening, MissingAndRepeatedChildrenAndOtherKindsGiveNoInstances) {
    const Expected<FlatScene> flat_scene = flatten(
        scene_with({Create{scene::RootId,
                           scene::Root{.name = {},
                                       .children = {ObjectId{20}, ObjectId{20}, ObjectId{99}, ObjectId{40}}}},
                    Create{ObjectId{20}, scene::Geometry{}}, Create{ObjectId{40}, scene::Camera{}}}));
    ASSERT_TRUE(flat_scene);
    ASSERT_EQ(flat_scene->instances.size(), 1u);
    EXPECT_TRUE(flat_scene->instances[0].path.empty());
}

TEST(Flattening, TheHintIsTheGeometrysOrThatOfTheNearestFlaggedTransform) {
    std::vector<scene::Entry> entries = two_copies();
    std::get<scene::Transform>(std::get<Create>(entries[1]).object).hint = MotionHint::Animated;
    std::get<scene::Transform>(std::get<Create>(entries[2]).object).hint = MotionHint::Static;
    const Expected<FlatScene> flat_scene = flatten(scene_with(entries));
    ASSERT_TRUE(flat_scene);
    EXPECT_EQ(flat_scene->instances[0].hint, MotionHint::Animated);
    EXPECT_EQ(flat_scene->instances[1].hint, MotionHint::Static);

    std::get<scene::Geometry>(std::get<Create>(entries[4]).object).hint = MotionHint::Static;
    const Expected<FlatScene> own = flatten(scene_with(entries));
    ASSERT_TRUE(own);
    EXPECT_EQ(own->instances[0].hint, MotionHint::Static);
}

TEST(Flattening, TheLayersAreThoseOfTheNearestTransformThatSetsSome) {
    std::vector<scene::Entry> entries = two_copies();
    const auto layers = [&](std::size_t entry) -> std::uint32_t& {
        return std::get<scene::Transform>(std::get<Create>(entries[entry]).object).layers;
    };
    const auto found = [&] {
        const FlatScene flat_scene = flatten(scene_with(entries)).value();
        return std::vector{flat_scene.instances.at(0).layers, flat_scene.instances.at(1).layers,
                           flat_scene.lights.at(0).layers};
    };
    EXPECT_EQ(found(), (std::vector{1u, 1u, 1u})) << "no transform sets layers: layer 0";
    layers(2) = 6;
    EXPECT_EQ(found(), (std::vector{1u, 6u, 6u}));
    layers(3) = 8;  // below both, above the geometry
    EXPECT_EQ(found(), (std::vector{8u, 8u, 6u}));
}

TEST(Flattening, TheLimitCountsInstancesAndLights) {
    const scene::Scene scene = scene_with(two_copies());
    EXPECT_TRUE(flatten(scene, 3));
    EXPECT_FALSE(flatten(scene, 2));
}

}  // namespace
}  // namespace tessera::backend
