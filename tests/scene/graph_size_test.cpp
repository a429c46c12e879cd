#include "mediator/scene/graph_size.h"

#include <gtest/gtest.h>

#include <random>

namespace tessera::scene {
namespace {

// A scene with an index, and its size counted after every edit, once incrementally and once anew.
struct GraphSizeTest : testing::Test {
    Scene scene;
    ReferrerIndex referrers;
    GraphSize size;

    void SetUp() override { apply({Create{RootId, Root{}}, Create{ObjectId{20}, Geometry{}}}); }

    void apply(const std::vector<Entry>& entries) {
        const auto changes = apply_and_observe(scene, entries);
        ASSERT_TRUE(changes);
        record(*changes, false);
    }

    void record(const std::vector<ObjectChange>& changes, bool reverted) {
        for (const ObjectChange& change : changes) {
            const Object *from = change.before.get(), *to = change.after.get();
            if (reverted) std::swap(from, to);
            referrers.replace(change.id, from, to);
        }
        size.changed(changes, referrers);
    }

    static Entry children_of(std::uint64_t id, const std::vector<std::uint64_t>& children) {
        std::vector<ObjectId> ids(children.size());
        for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = ObjectId{children[i]};
        if (ObjectId{id} == RootId)
            return Update{RootId, children_field(ObjectKind::Root), Root{.name = {}, .children = ids}};
        Transform transform;
        transform.children = ids;
        return Update{ObjectId{id}, children_field(ObjectKind::Transform), transform};
    }

    static Entry transform(std::uint64_t id, const std::vector<ObjectId>& children) {
        Transform made;
        made.children = children;
        return Create{ObjectId{id}, made};
    }

    bool incremental(std::size_t limit = MaxPlacements) { return size.count(scene, limit).has_value(); }
    bool anew(std::size_t limit = MaxPlacements) const { return GraphSize().count(scene, limit).has_value(); }
};

TEST_F(GraphSizeTest, ARefusedEditThatIsTakenBackLeavesNoTrace) {
    std::vector<Entry> chain;
    for (std::uint64_t i = 0; i < MaxDepth; ++i)
        chain.push_back(transform(100 + i, {i + 1 == MaxDepth ? ObjectId{20} : ObjectId{101 + i}}));
    apply(chain);
    apply({children_of(RootId.value, {100})});
    EXPECT_TRUE(incremental());
    const auto deeper =
        apply_and_observe(scene, {transform(5000, {ObjectId{100}}), children_of(RootId.value, {5000})});
    ASSERT_TRUE(deeper);
    record(*deeper, false);
    EXPECT_FALSE(incremental());
    EXPECT_FALSE(incremental()) << "asking again does not make it smaller";
    ASSERT_TRUE(scene.apply_entries(inverse(*deeper)));
    record(*deeper, true);
    EXPECT_TRUE(incremental());
}

TEST_F(GraphSizeTest, ADeepSubtreeIsNoticedWhereverItIsHungIn) {
    // Two chains of 600 are fine side by side and too deep one below the other.
    std::vector<Entry> chains;
    for (const std::uint64_t first : {1000, 2000}) {
        for (std::uint64_t i = 0; i < 600; ++i) {
            const std::uint64_t end = first == 1000 ? 20 : 21;
            chains.push_back(transform(first + i, {ObjectId{i + 1 == 600 ? end : first + i + 1}}));
        }
    }
    chains.push_back(Create{ObjectId{21}, Light{}});
    apply(chains);
    apply({children_of(RootId.value, {1000, 2000})});
    EXPECT_TRUE(incremental());
    apply({children_of(1599, {20, 2000})});
    EXPECT_FALSE(incremental());
    apply({children_of(1599, {20})});
    EXPECT_TRUE(incremental());
}

TEST_F(GraphSizeTest, TheIncrementalCountAgreesWithAFreshOneOverRandomEdits) {
    std::mt19937 random(3);
    constexpr std::uint64_t Count = 40;
    std::vector<Entry> all;
    for (std::uint64_t i = 0; i < Count; ++i) all.push_back(transform(100 + i, {}));
    apply(all);
    int refused = 0, allowed = 0;
    for (int step = 0; step < 3000; ++step) {
        // Children have larger ids, so that there is no cycle; many shared ones make the graph large.
        const std::uint64_t parent = std::uniform_int_distribution<std::uint64_t>(0, Count)(random);
        std::vector<std::uint64_t> children;
        for (std::uint64_t child = parent; child < Count; ++child) {
            if (random() % 4 == 0) children.push_back(100 + child);
        }
        if (random() % 2 == 0) children.push_back(20);
        apply({children_of(parent == 0 ? RootId.value : 99 + parent, children)});
        const bool fits = incremental(300);
        EXPECT_EQ(fits, anew(300)) << "step " << step;
        ++(fits ? allowed : refused);
    }
    EXPECT_GT(refused, 300);
    EXPECT_GT(allowed, 100);
}

}  // namespace
}  // namespace tessera::scene
