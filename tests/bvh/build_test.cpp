// Invariants that the traversal relies on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

#include "backends/vulkan/bvh/quantise.h"
#include "tests/bvh/traced_scene.h"

namespace tessera::vulkan {

namespace {

using shading::BvhNode;

// Walks a mesh's tree as the traversal does and checks all that it relies on.
class Walk {
  public:
    Walk(const WideTree& tree, const MeshData& mesh)
        : tree_(tree), mesh_(mesh), seen_(tree.primitives.size()) {
        visit(0, 1);
        EXPECT_EQ(deepest_, tree.depth);
        EXPECT_EQ(nodes_, tree.nodes.size());
        EXPECT_TRUE(std::all_of(seen_.begin(), seen_.end(), [](int times) { return times == 1; }));
    }

  private:
    void expect_inside(const BvhNode& node, std::uint32_t slot, const Box& box) {
        const PreciseBox around = quantised_box(node, slot);
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_LT(around.low[axis], box.low[axis]);
            EXPECT_GT(around.high[axis], box.high[axis]);
        }
    }

    Box visit(std::uint32_t at, std::uint32_t depth) {
        ++nodes_;
        deepest_ = std::max(deepest_, depth);
        const BvhNode& node = tree_.nodes[at];
        const std::uint32_t inner = node.frame >> 24u;
        EXPECT_LE(inner, shading::BvhWidth);
        Box whole;
        for (std::uint32_t slot = 0; slot < shading::BvhWidth; ++slot) {
            const std::uint32_t leaf = node.leaves[slot / 4] >> (8 * (slot % 4)) & 0xffu;
            Box box;
            if (slot < inner) {
                EXPECT_EQ(leaf, 0u);
                EXPECT_GT(node.first_child + slot, at);
                box = visit(node.first_child + slot, depth + 1);
            }
            for (std::uint32_t i = 0; i < 3; ++i) {
                if ((leaf >> (5 + i) & 1u) == 0) continue;
                const std::uint32_t place = node.first_triangle + (leaf & 31u) + i;
                ++seen_.at(place);
                for (int corner = 0; corner < 3; ++corner) {
                    box.add(mesh_.positions[mesh_.triangles[tree_.primitives[place]][corner]]);
                }
            }
            if (!box.empty()) expect_inside(node, slot, box);
            whole.add(box);
        }
        return whole;
    }

    const WideTree& tree_;
    const MeshData mesh_;
    std::vector<int> seen_;
    std::uint32_t deepest_ = 0;
    std::size_t nodes_ = 0;
};

TEST(Build, EveryTriangleIsStoredOnceWithinItsBoxes) {
    BinaryTreeBuilder builder;
    CounterRandom random(11);
    for (const std::uint32_t count : {1u, 2u, 3u, 4u, 23u, 24u, 25u, 1000u, 20000u}) {
        SCOPED_TRACE(count);
        const TestMesh mesh = random_mesh(random, count, 10.0f);
        const WideTree tree = build_mesh(builder, mesh.data());
        EXPECT_EQ(tree.primitives.size(), count);
        Walk(tree, mesh.data());
    }
}

TEST(Build, NodesAreFull) {
    BinaryTreeBuilder builder;
    const TestMesh mesh = ball(64, 5.0f, glm::vec3(0.0f));
    const WideTree tree = build_mesh(builder, mesh.data());
    EXPECT_LT(static_cast<double>(tree.nodes.size()), 0.11 * static_cast<double>(mesh.triangles.size()));
    EXPECT_LE(tree.depth, 8u);
}

// Sizes in geometric progression make the cheapest tree a chain.
TEST(Build, DepthIsBounded) {
    BinaryTreeBuilder builder;
    TestMesh mesh;
    for (int i = 0; i < 180; ++i) {
        const float s = std::ldexp(1.0f, i - 120);
        mesh.add({s, 0, 0}, {2 * s, 0, 0}, {s, s, 0});
    }
    const WideTree tree = build_mesh(builder, mesh.data());
    EXPECT_LE(tree.depth, shading::BvhMeshDepth);
    Walk(tree, mesh.data());
}

TEST(Build, TooDeepTreesAreBalanced) {
    BinaryTreeBuilder builder;
    for (const std::uint32_t count : {1u, 9u, 30u, 5000u}) {
        std::vector<Box> boxes;
        CounterRandom random(12);
        for (std::uint32_t i = 0; i < count; ++i) {
            Box box;
            box.add(random_point(random, -1.0f, 1.0f));
            boxes.push_back(box);
        }
        const BinaryNode* root = builder.build(boxes, {});
        for (const Level level : {Level::Mesh, Level::Top}) {
            const WideTree tree = collapse(root, level, 0);
            const double leaves = level == Level::Mesh ? count / 3.0 : count;
            EXPECT_LE(tree.depth, 1 + std::ceil(std::max(0.0, std::log2(leaves / 8.0) / 3.0)));
            std::vector<std::uint32_t> all;
            for (const std::uint32_t primitive : tree.primitives) {
                if (primitive != WideTree::NoPrimitive) all.push_back(primitive);
            }
            std::sort(all.begin(), all.end());
            ASSERT_EQ(all.size(), count);
            for (std::uint32_t i = 0; i < count; ++i) ASSERT_EQ(all[i], i);
        }
    }
}

TEST(Build, CoincidentTriangles) {
    BinaryTreeBuilder builder;
    TestMesh mesh;
    for (int i = 0; i < 5000; ++i) mesh.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const WideTree tree = build_mesh(builder, mesh.data());
    EXPECT_LE(tree.depth, shading::BvhMeshDepth);
    Walk(tree, mesh.data());
}

TEST(Refit, FollowsNewPositions) {
    CounterRandom random(13);
    BinaryTreeBuilder builder;
    TestMesh mesh = ball(20, 5.0f, glm::vec3(0.0f));
    WideTree tree = build_mesh(builder, mesh.data());
    const WideTree built = tree;
    EXPECT_TRUE(refit_mesh(tree, mesh.data(), built.cost));
    EXPECT_EQ(0, std::memcmp(tree.nodes.data(), built.nodes.data(), built.nodes.size() * sizeof(BvhNode)));
    EXPECT_EQ(tree.cost, built.cost);
    for (glm::vec3& p : mesh.positions) p = p * glm::vec3(2.0f, 1.0f, 1.0f) + glm::vec3(0.0f, 3.0f, 0.0f);
    EXPECT_TRUE(refit_mesh(tree, mesh.data(), built.cost));
    Walk(tree, mesh.data());
    // Torn apart: correct, but due for a rebuild.
    for (glm::vec3& p : mesh.positions) p = random_point(random, -5.0f, 5.0f);
    EXPECT_FALSE(refit_mesh(tree, mesh.data(), built.cost));
    Walk(tree, mesh.data());
}

TEST(Refit, VanishingAndAppearingTriangles) {
    BinaryTreeBuilder builder;
    TestMesh mesh;
    mesh.add({-9, -9, 3}, {9, -9, 3}, {0, 9, 3});
    mesh.add({-9, -9, 5}, {9, -9, 5}, {0, 9, 5});
    TracedScene scene({mesh}, {{}});
    const TestRay ray{glm::vec3(0.0f), glm::vec3(0.0f, 0.0f, 1.0f)};
    EXPECT_EQ(scene.trace(ray).distance, 3.0f);
    std::vector<glm::vec3> moved = mesh.positions;
    moved[1] = moved[0];
    scene.move(0, moved);
    EXPECT_EQ(scene.trace(ray).distance, 5.0f);

    const TestMesh flat{moved, mesh.triangles};
    WideTree tree = build_mesh(builder, flat.data());
    EXPECT_FALSE(refit_mesh(tree, mesh.data(), tree.cost)) << "the tree has no place for the first triangle";
}

}  // namespace

}  // namespace tessera::vulkan
