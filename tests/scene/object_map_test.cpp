#include "mediator/scene/object_map.h"

#include <gtest/gtest.h>

#include <map>
#include <thread>

#include "mediator/base/random.h"

namespace tessera::scene {
namespace {

using Reference = std::map<ObjectId, std::shared_ptr<const Object>>;

std::shared_ptr<const Object> some_object() {
    return std::make_shared<const Object>(Camera{});
}

void expect_same(const ObjectMap& map, const Reference& reference) {
    ASSERT_EQ(map.size(), reference.size());
    auto it = map.begin();
    for (const auto& [id, object] : reference) {
        ASSERT_NE(it, map.end());
        EXPECT_EQ(it->first, id);
        EXPECT_EQ(it->second, object);
        ++it;
    }
    EXPECT_EQ(it, map.end());
}

TEST(ObjectMap, BehavesLikeAMapWithIndependentCopies) {
    CounterRandom random(7);
    ObjectMap map;
    Reference reference;
    std::vector<std::pair<ObjectMap, Reference>> copies;
    for (int step = 0; step < 20000; ++step) {
        const ObjectId id{1 + random.below(3000)};
        if (random.below(3) == 0) {
            map.erase(id);
            reference.erase(id);
        } else {
            const auto object = some_object();
            map.set(id, object);
            reference[id] = object;
        }
        const ObjectId asked{1 + random.below(3000)};
        const auto it = map.lower_bound(asked);
        const auto expected = reference.lower_bound(asked);
        ASSERT_EQ(it == map.end(), expected == reference.end());
        if (expected != reference.end()) {
            ASSERT_EQ(it->first, expected->first);
        }
        ASSERT_EQ(map.find(asked) == map.end(), !reference.contains(asked));
        if (step % 2000 == 0) copies.emplace_back(map, reference);
    }
    expect_same(map, reference);
    for (const auto& [copy, then] : copies) expect_same(copy, then);
    for (const auto& [id, object] : reference) map.erase(id);
    EXPECT_EQ(map.size(), 0u);
    EXPECT_EQ(map.begin(), map.end());
}

TEST(ObjectMap, IteratesBackwards) {
    ObjectMap map;
    for (std::uint64_t id = 1; id <= 1000; ++id) map.set(ObjectId{id}, some_object());
    std::uint64_t id = 1000;
    for (auto it = map.rbegin(); id > 0; ++it, --id) ASSERT_EQ(it->first, ObjectId{id});
}

// What the editor and the readers of a scene do: under a thread sanitizer, too.
TEST(ObjectMap, CopiesMayBeReadWhileTheOriginalChanges) {
    ObjectMap map;
    for (std::uint64_t id = 1; id <= 2000; ++id) map.set(ObjectId{id}, some_object());
    for (int round = 0; round < 20; ++round) {
        std::jthread reader([copy = map] {
            std::uint64_t sum = 0;
            for (const auto& [id, object] : copy) sum += id.value + object->index() * 0;
            EXPECT_EQ(sum, 2000u * 2001u / 2);
        });
        for (std::uint64_t id = 1; id <= 2000; id += 97) map.set(ObjectId{id}, some_object());
    }
}

}  // namespace
}  // namespace tessera::scene
