#include "mediator/backend/lowering.h"

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

scene::Scene made(const std::vector<scene::Entry>& entries) {
    test::SceneBuilder builder;
    builder.edit(entries);
    return builder.scene();
}

TEST(Lowering, KeepsSharingAndMultipliesNestedTransforms) {
    const Expected<Lowered> lowered = lower(made(two_copies()));
    ASSERT_TRUE(lowered);
    ASSERT_EQ(lowered->instances.size(), 2u);
    EXPECT_EQ(lowered->instances[0].geometry, ObjectId{20});
    EXPECT_EQ(lowered->instances[0].path, (std::vector{ObjectId{10}, ObjectId{12}}));
    EXPECT_EQ(lowered->instances[0].world_from_object, moved(1, 0, 3));
    EXPECT_EQ(lowered->instances[1].world_from_object, moved(0, 2, 3));
    ASSERT_EQ(lowered->lights.size(), 1u);
    EXPECT_EQ(lowered->lights[0].world_from_light, moved(0, 2, 0));
}

std::vector<scene::Entry> moving_copies(const std::vector<glm::dmat4>& outer,
                                        const std::vector<glm::dmat4>& inner) {
    std::vector<scene::Entry> entries = two_copies();
    std::get<scene::Transform>(std::get<Create>(entries[1]).object).motion = outer;
    std::get<scene::Transform>(std::get<Create>(entries[3]).object).motion = inner;
    return entries;
}

TEST(Lowering, OneTransformThatMovesKeepsItsSteps) {
    const Expected<Lowered> lowered = lower(made(moving_copies({moved(2, 0, 0), moved(5, 0, 0)}, {})));
    ASSERT_TRUE(lowered);
    EXPECT_EQ(lowered->instances[0].motion, (std::vector{moved(2, 0, 3), moved(5, 0, 3)}));
    EXPECT_TRUE(lowered->instances[1].motion.empty()) << "it hangs elsewhere";
    EXPECT_TRUE(lowered->lights[0].motion.empty());
}

TEST(Lowering, StepsOfSeveralThatMoveFallTogether) {
    const std::vector<glm::dmat4> outer{moved(2, 0, 0), moved(3, 0, 0)},
        inner{moved(0, 1, 3), moved(0, 5, 3), moved(0, 6, 3)};
    const Expected<Lowered> lowered = lower(made(moving_copies(outer, inner)));
    ASSERT_TRUE(lowered);
    // Twelve, since six are too few for what is no straight line; the first goes from 1 by 2 and 3, the other
    // from 0 by 1, 5 and 6.
    const std::vector<glm::dmat4>& motion = lowered->instances[0].motion;
    ASSERT_EQ(motion.size(), 12u);
    EXPECT_LT(glm::distance(motion[5][3], moved(2, 3, 3)[3]), 1e-12);
    EXPECT_LT(glm::distance(motion[3][3], glm::dvec4(1.0 + 2.0 / 3.0, 1, 3, 1)), 1e-12);
    EXPECT_LT(glm::distance(motion[11][3], moved(3, 6, 3)[3]), 1e-12);
    EXPECT_EQ(lowered->instances[1].motion, (std::vector{moved(0, 3, 3), moved(0, 7, 3), moved(0, 8, 3)}));
}

TEST(Lowering, StepsThatAreAllTheSameAreNoMotion) {
    const Expected<Lowered> lowered = lower(made(moving_copies({moved(1, 0, 0), moved(1, 0, 0)}, {})));
    ASSERT_TRUE(lowered);
    EXPECT_TRUE(lowered->instances[0].motion.empty());
}

TEST(Lowering, DoesNotDependOnTheOrderOfCreation) {
    std::vector<scene::Entry> entries = two_copies();
    const Expected<Lowered> forward = lower(made(entries));
    std::reverse(entries.begin(), entries.end());
    auto& root = std::get<scene::Root>(std::get<Create>(entries.back()).object);
    std::reverse(root.children.begin(), root.children.end());
    const Expected<Lowered> backward = lower(made(entries));
    ASSERT_TRUE(forward && backward);
    ASSERT_EQ(forward->instances.size(), backward->instances.size());
    for (std::size_t i = 0; i < forward->instances.size(); ++i) {
        EXPECT_EQ(forward->instances[i].path, backward->instances[i].path);
        EXPECT_EQ(forward->instances[i].world_from_object, backward->instances[i].world_from_object);
    }
}

TEST(Lowering, ACycleIsAnErrorThatNamesATransform) {
    const Expected<Lowered> lowered =
        lower(made({Create{scene::RootId, scene::Root{.name = {}, .children = {ObjectId{10}}}},
                    Create{ObjectId{10}, transform(moved(1, 0, 0), {ObjectId{11}})},
                    Create{ObjectId{11}, transform(moved(1, 0, 0), {ObjectId{10}})}}));
    ASSERT_FALSE(lowered);
    EXPECT_EQ(lowered.error().code(), ErrorCode::InvalidInput);
    EXPECT_NE(std::string(lowered.error().what()).find("contains itself"), std::string::npos);
}

TEST(Lowering, SharingThatDoublesAtEveryLevelIsRefusedAtOnce) {
    std::vector<scene::Entry> entries{
        Create{scene::RootId, scene::Root{.name = {}, .children = {ObjectId{100}}}},
        Create{ObjectId{20}, scene::Geometry{}}};
    constexpr std::uint64_t Levels = 60;
    for (std::uint64_t i = 0; i < Levels; ++i) {
        const bool last = i + 1 == Levels;
        const ObjectId below = last ? ObjectId{20} : ObjectId{100 + 2 * (i + 1)};
        const ObjectId beside = last ? ObjectId{20} : ObjectId{101 + 2 * (i + 1)};
        for (const std::uint64_t id : {100 + 2 * i, 101 + 2 * i}) {
            entries.push_back(Create{ObjectId{id}, transform(glm::dmat4(1.0), {below, beside})});
        }
    }
    const Expected<Lowered> lowered = lower(made(entries));
    ASSERT_FALSE(lowered);
    EXPECT_EQ(lowered.error().code(), ErrorCode::InvalidInput);

    // The same graph with nothing at its end costs nothing.
    entries[1] = Create{ObjectId{20}, scene::Camera{}};
    const Expected<Lowered> empty = lower(made(entries));
    ASSERT_TRUE(empty);
    EXPECT_TRUE(empty->instances.empty());
}

TEST(Lowering, AChainThatIsTooDeepIsRefused) {
    std::vector<scene::Entry> entries{
        Create{scene::RootId, scene::Root{.name = {}, .children = {ObjectId{100}}}},
        Create{ObjectId{20}, scene::Geometry{}}};
    const auto chain = [&](std::uint64_t depth) {
        std::vector<scene::Entry> result = entries;
        for (std::uint64_t i = 0; i < depth; ++i) {
            const ObjectId child = i + 1 == depth ? ObjectId{20} : ObjectId{101 + i};
            result.push_back(Create{ObjectId{100 + i}, transform(glm::dmat4(1.0), {child})});
        }
        return lower(made(result));
    };
    EXPECT_TRUE(chain(MaxDepth));
    EXPECT_FALSE(chain(MaxDepth + 1));
    EXPECT_FALSE(chain(50'000));
}

TEST(Lowering, MissingAndRepeatedChildrenAndOtherKindsAreNoInstances) {
    const Expected<Lowered> lowered =
        lower(made({Create{scene::RootId,
                           scene::Root{.name = {},
                                       .children = {ObjectId{20}, ObjectId{20}, ObjectId{99}, ObjectId{40}}}},
                    Create{ObjectId{20}, scene::Geometry{}}, Create{ObjectId{40}, scene::Camera{}}}));
    ASSERT_TRUE(lowered);
    ASSERT_EQ(lowered->instances.size(), 1u);
    EXPECT_TRUE(lowered->instances[0].path.empty());
}

TEST(Lowering, TheHintIsTheGeometrysOrThatOfTheNearestFlaggedTransform) {
    std::vector<scene::Entry> entries = two_copies();
    std::get<scene::Transform>(std::get<Create>(entries[1]).object).hint = MotionHint::Animated;
    std::get<scene::Transform>(std::get<Create>(entries[2]).object).hint = MotionHint::Static;
    const Expected<Lowered> lowered = lower(made(entries));
    ASSERT_TRUE(lowered);
    EXPECT_EQ(lowered->instances[0].hint, MotionHint::Animated);
    EXPECT_EQ(lowered->instances[1].hint, MotionHint::Static);

    std::get<scene::Geometry>(std::get<Create>(entries[4]).object).hint = MotionHint::Static;
    const Expected<Lowered> own = lower(made(entries));
    ASSERT_TRUE(own);
    EXPECT_EQ(own->instances[0].hint, MotionHint::Static);
}

TEST(Lowering, TheLayersAreThoseOfTheNearestTransformThatNamesSome) {
    std::vector<scene::Entry> entries = two_copies();
    const auto layers = [&](std::size_t entry) -> std::uint32_t& {
        return std::get<scene::Transform>(std::get<Create>(entries[entry]).object).layers;
    };
    const auto found = [&] {
        const Lowered lowered = lower(made(entries)).value();
        return std::vector{lowered.instances.at(0).layers, lowered.instances.at(1).layers,
                           lowered.lights.at(0).layers};
    };
    EXPECT_EQ(found(), (std::vector{1u, 1u, 1u})) << "nobody names any: layer 0";
    layers(2) = 6;
    EXPECT_EQ(found(), (std::vector{1u, 6u, 6u}));
    layers(3) = 8;  // below both, above the geometry
    EXPECT_EQ(found(), (std::vector{8u, 8u, 6u}));
}

TEST(Lowering, TheLimitCountsInstancesAndLights) {
    const scene::Scene scene = made(two_copies());
    EXPECT_TRUE(lower(scene, 3));
    EXPECT_FALSE(lower(scene, 2));
}

}  // namespace
}  // namespace tessera::backend
