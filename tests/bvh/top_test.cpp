// The top level follows its instances.
#include <gtest/gtest.h>

#include <cstring>

#include "backends/vulkan/bvh/top_bvh.h"
#include "tests/bvh/traced_scene.h"

namespace tessera::vulkan {

namespace {

std::vector<PlacedMesh> some_instances(std::uint32_t count) {
    CounterRandom random(71);
    std::vector<PlacedMesh> instances(count);
    for (PlacedMesh& placed : instances) {
        placed.box.add({-1.0f, -1.0f, -1.0f});
        placed.box.add({1.0f, 1.0f, 1.0f});
        placed.translation = random_point(random, -30.0f, 30.0f);
        placed.nodes = static_cast<std::uint32_t>(random.below(1000));
    }
    return instances;
}

// Each instance once, where its parent looks for it.
std::vector<int> places_of_instances(const TopBvh& top, std::uint32_t count) {
    std::vector<int> places(count, -1);
    for (std::size_t at = 0; at < top.tree.nodes.size(); ++at) {
        if (top.tree.primitives[at] != WideTree::NoPrimitive) continue;
        const shading::BvhNode& node = top.tree.nodes[at];
        const std::uint32_t inner = node.frame >> 24u;
        for (std::uint32_t i = 0; i < node.first_triangle; ++i) {
            const std::uint32_t place = node.first_child + inner + i;
            shading::BvhInstance record;
            std::memcpy(&record, top.row.data() + place * sizeof record, sizeof record);
            EXPECT_EQ(places.at(record.instance), -1);
            places[record.instance] = static_cast<int>(place);
        }
    }
    return places;
}

TEST(Top, StoresEveryInstanceOnce) {
    BinaryTreeBuilder builder;
    for (const std::uint32_t count : {0u, 1u, 8u, 9u, 1000u}) {
        const TopBvh top = build_top(builder, some_instances(count));
        for (const int place : places_of_instances(top, count)) EXPECT_GT(place, 0);
        EXPECT_LE(top.tree.depth, shading::BvhTopDepth);
        EXPECT_EQ(top.row.size(), top.tree.nodes.size() * sizeof(shading::BvhNode));
    }
}

TEST(Top, RefitFollowsMovedInstances) {
    BinaryTreeBuilder builder;
    std::vector<PlacedMesh> instances = some_instances(300);
    const TopBvh built = build_top(builder, instances);
    TopBvh top = built;
    EXPECT_TRUE(refit_top(top, instances, built.tree.cost));
    EXPECT_EQ(top.row, built.row);
    for (PlacedMesh& placed : instances) placed.translation *= 2.0f;
    instances[7].nodes += 16;
    EXPECT_TRUE(refit_top(top, instances, built.tree.cost));
    const int place = places_of_instances(top, 300)[7];
    shading::BvhInstance record;
    std::memcpy(&record, top.row.data() + place * sizeof record, sizeof record);
    EXPECT_EQ(record.nodes, instances[7].nodes);
    EXPECT_EQ(record.object_x.w, -instances[7].translation.x);
    CounterRandom random(72);
    for (PlacedMesh& placed : instances) placed.translation = random_point(random, -30.0f, 30.0f);
    EXPECT_FALSE(refit_top(top, instances, built.tree.cost))
        << "places have nothing to do with the tree any more";
}

TEST(Top, RefitRejectsOtherInstances) {
    BinaryTreeBuilder builder;
    std::vector<PlacedMesh> instances = some_instances(20);
    TopBvh top = build_top(builder, instances);
    const TopBvh built = top;
    std::vector<PlacedMesh> fewer = instances, more = instances, flat = instances;
    fewer.pop_back();
    more.push_back(instances[0]);
    flat[3].linear[0] = glm::vec3(0.0f);
    for (const auto& changed : {fewer, more, flat}) {
        EXPECT_FALSE(refit_top(top, changed, built.tree.cost));
        EXPECT_EQ(top.row, built.row);
    }
}

}  // namespace

}  // namespace tessera::vulkan
