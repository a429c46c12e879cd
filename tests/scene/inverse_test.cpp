#include "mediator/scene/inverse.h"

#include <gtest/gtest.h>

#include "mediator/scene/validate.h"
#include "tests/scene/random_edits.h"

namespace tessera::scene {
namespace {

Scene rooted_scene() {
    Scene scene;
    EXPECT_TRUE(scene.apply_entries({Create{RootId, Root{}}}));
    return scene;
}

void index(ReferrerIndex& referrers, const std::vector<ObjectChange>& changes) {
    for (const ObjectChange& change : changes)
        referrers.replace(change.id, change.before.get(), change.after.get());
}

TEST(Inverse, UndoesRandomEditsBitForBit) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Scene scene = rooted_scene();
        RandomEdits edits(seed, 100);
        std::vector<std::pair<Hash128, std::vector<Entry>>> way_back;
        for (int i = 0; i < 200; ++i) {
            const Hash128 before = scene.state_hash();
            const auto changes = apply_and_observe(scene, edits.next(scene));
            ASSERT_TRUE(changes) << changes.error().what();
            way_back.emplace_back(before, inverse(*changes));
        }
        ASSERT_GT(scene.objects().size(), 10u);
        for (auto step = way_back.rbegin(); step != way_back.rend(); ++step) {
            ASSERT_TRUE(scene.apply_entries(step->second));
            ASSERT_EQ(scene.state_hash(), step->first) << "seed " << seed;
        }
        EXPECT_EQ(scene.objects().size(), 1u);
    }
}

TEST(Inverse, RestoresAnObjectThatChangedItsKind) {
    Scene scene = rooted_scene();
    ASSERT_TRUE(scene.apply_entries({Create{ObjectId{5}, Light{.name = "lamp"}}}));
    const Hash128 before = scene.state_hash();
    const auto changes =
        apply_and_observe(scene, {Remove{ObjectId{5}}, Create{ObjectId{5}, Camera{.name = "eye"}}});
    ASSERT_TRUE(changes);
    ASSERT_EQ(changes->size(), 1u);
    EXPECT_FALSE(changes->front().is_update());
    ASSERT_TRUE(scene.apply_entries(inverse(*changes)));
    EXPECT_EQ(scene.state_hash(), before);
}

TEST(Inverse, HoldsOnlyTheFieldsItNeeds) {
    Scene scene = rooted_scene();
    ASSERT_TRUE(scene.apply_entries({Create{ObjectId{5}, Material{.name = "red", .roughness = 0.25f}}}));
    Material smooth;
    smooth.roughness = 0.5f;
    const auto changes = apply_and_observe(
        scene, {Update{ObjectId{5}, Fields<Material>(&Material::roughness).bits(), smooth}});
    ASSERT_TRUE(changes);
    const std::vector<Entry> back = inverse(*changes);
    ASSERT_EQ(back.size(), 1u);
    const auto& update = std::get<Update>(back[0]);
    EXPECT_EQ(update.mask, Fields<Material>(&Material::roughness).bits());
    EXPECT_EQ(std::get<Material>(update.fields).roughness, 0.25f);
    EXPECT_TRUE(name(update.fields).empty());
}

// The incremental and the full validation reject the same edits.
TEST(ValidateChanges, AgreesWithTheCheckOfTheWholeScene) {
    int refused = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Scene scene = rooted_scene();
        ReferrerIndex referrers;
        RandomEdits edits(seed, 100);
        for (int i = 0; i < 150; ++i) {
            std::vector<Entry> entries = edits.below(4) ? edits.next(scene) : edits.impossible(scene);
            // Now and then something goes that others still refer to.
            const ObjectId material = edits.some(scene, ObjectKind::Material);
            if (edits.below(20) == 0 && material) entries = {Remove{material}};
            const auto changes = apply_and_observe(scene, entries);
            if (!changes) continue;
            index(referrers, *changes);
            const bool valid = validate(scene).empty();
            ASSERT_EQ(validate_changes(scene, referrers, *changes).empty(), valid)
                << "seed " << seed << ", edit " << i;
            if (valid) continue;
            ++refused;
            const auto back = apply_and_observe(scene, inverse(*changes));
            ASSERT_TRUE(back);
            index(referrers, *back);
        }
    }
    EXPECT_GT(refused, 100);
}

TEST(ValidateChanges, FindsCyclesOfLargeEditsToo) {
    Scene scene = rooted_scene();
    ReferrerIndex referrers;
    std::vector<Entry> chain;
    constexpr std::uint64_t Length = 1000, First = 100;
    for (std::uint64_t i = 0; i < Length; ++i) {
        Transform transform;
        if (i + 1 < Length) transform.children = {ObjectId{First + i + 1}};
        chain.push_back(Create{ObjectId{First + i}, transform});
    }
    const auto created = apply_and_observe(scene, chain);
    ASSERT_TRUE(created);
    index(referrers, *created);
    EXPECT_TRUE(validate_changes(scene, referrers, *created).empty());
    Transform back_to_first;
    back_to_first.children = {ObjectId{First}};
    const auto closed =
        apply_and_observe(scene, {Update{ObjectId{First + Length - 1},
                                         Fields<Transform>(&Transform::children).bits(), back_to_first}});
    ASSERT_TRUE(closed);
    index(referrers, *closed);
    EXPECT_EQ(validate_changes(scene, referrers, *closed).size(), 1u) << "one new link closes it";
    std::vector<ObjectChange> both = *created;
    both.push_back(closed->front());
    EXPECT_FALSE(validate_changes(scene, referrers, both).empty()) << "all links at once";
}

TEST(ReferrerIndex, HoldsExactlyTheCurrentReferences) {
    Scene scene = rooted_scene();
    ReferrerIndex referrers;
    RandomEdits edits(3, 100);
    for (int i = 0; i < 300; ++i) {
        const auto changes = apply_and_observe(scene, edits.next(scene));
        ASSERT_TRUE(changes);
        index(referrers, *changes);
    }
    ReferrerIndex rebuilt;
    for (const auto& [id, object] : scene.objects()) rebuilt.replace(id, nullptr, object.get());
    for (std::uint64_t id = 1; id < 1000; ++id)
        ASSERT_EQ(referrers.referrers(ObjectId{id}), rebuilt.referrers(ObjectId{id}));
}

}  // namespace
}  // namespace tessera::scene
