// Serialized trees, and malformed ones.
#include "backends/vulkan/bvh/tree_serialization.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>

#include "tests/bvh/traced_scene.h"

namespace tessera::vulkan {

namespace {

using shading::BvhNode;

bool equal(const WideTree& a, const WideTree& b) {
    return a.nodes.size() == b.nodes.size() &&
           std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(BvhNode)) == 0 &&
           a.primitives == b.primitives && a.depth == b.depth && a.cost == b.cost && a.box.low == b.box.low &&
           a.box.high == b.box.high;
}

struct Built {
    explicit Built(TestMesh made) : mesh(std::move(made)) {}
    TestMesh mesh;
    BinaryTreeBuilder builder;
    WideTree tree = build_mesh(builder, mesh.data());
};

// Bytes taken apart and put together: the cost, one word a node, one a primitive.
struct Parts {
    double cost = 0.0;
    std::vector<std::uint32_t> nodes, primitives;

    explicit Parts(const std::vector<std::byte>& bytes) {
        std::array<std::uint32_t, 2> counts{};
        std::memcpy(&cost, bytes.data(), 8);
        std::memcpy(counts.data(), bytes.data() + 8, 8);
        nodes.resize(counts[0]);
        primitives.resize(counts[1]);
        std::memcpy(nodes.data(), bytes.data() + 16, 4 * nodes.size());
        std::memcpy(primitives.data(), bytes.data() + 16 + 4 * nodes.size(), 4 * primitives.size());
    }
    std::vector<std::byte> bytes() const {
        const std::array counts{static_cast<std::uint32_t>(nodes.size()),
                                static_cast<std::uint32_t>(primitives.size())};
        std::vector<std::byte> all(16 + 4 * (nodes.size() + primitives.size()));
        std::memcpy(all.data(), &cost, 8);
        std::memcpy(all.data() + 8, counts.data(), 8);
        std::copy(nodes.begin(), nodes.end(), reinterpret_cast<std::uint32_t*>(all.data() + 16));
        std::copy(primitives.begin(), primitives.end(),
                  reinterpret_cast<std::uint32_t*>(all.data() + 16 + 4 * nodes.size()));
        return all;
    }
};

TEST(TreeSerialization, RoundTripsBitForBit) {
    CounterRandom random(60);
    TestMesh sizes;  // its cheapest tree is a chain: a balanced one is built instead
    for (int i = 0; i < 180; ++i) {
        const float s = std::ldexp(1.0f, i - 120);
        sizes.add({s, 0, 0}, {2 * s, 0, 0}, {s, s, 0});
    }
    TestMesh holes = random_mesh(random, 3000, 10.0f);  // some cannot be hit
    for (std::size_t i = 0; i < holes.triangles.size(); i += 7) holes.triangles[i].y = holes.triangles[i].x;
    for (const TestMesh& mesh : {TestMesh{}, random_mesh(random, 1, 1.0f), random_mesh(random, 25, 1.0f),
                                 ball(24, 5.0f, glm::vec3(0.0f)), sizes, holes}) {
        const Built built(mesh);
        const auto back = deserialize_tree(serialize_tree(built.tree), built.mesh.data());
        ASSERT_TRUE(back) << mesh.triangles.size();
        EXPECT_TRUE(equal(*back, built.tree)) << mesh.triangles.size();
    }
}

// Files with valid checksums can still be malformed: truncated, extended, or changed at any position.
TEST(TreeSerialization, CorruptedBytesGiveTheSameTreeOrNone) {
    const Built built(ball(24, 5.0f, glm::vec3(0.0f)));
    const std::vector<std::byte> good = serialize_tree(built.tree);
    for (std::size_t length = 0; length < good.size(); length += 1 + good.size() / 499) {
        EXPECT_FALSE(deserialize_tree(std::span(good).first(length), built.mesh.data())) << length;
    }
    CounterRandom random(61);
    for (int round = 0; round < 4000; ++round) {
        std::vector<std::byte> bytes = good;
        const bool header = round < 16 * 8;
        const std::size_t changes = header ? 1 : 1 + random.below(3);
        for (std::size_t i = 0; i < changes; ++i) {
            const std::size_t place =
                header ? static_cast<std::size_t>(round / 8) : random.below(bytes.size());
            bytes[place] ^= static_cast<std::byte>(header ? 1u << (round % 8) : 1 + random.below(255));
        }
        if (round % 5 == 4) bytes.resize(random.below(2 * bytes.size()));
        const auto tree = deserialize_tree(bytes, built.mesh.data());
        // Where two changes cancel, or the leaf's triangles have changed places.
        if (!tree) continue;
        EXPECT_EQ(tree->cost, built.tree.cost);
        EXPECT_EQ(tree->primitives.size(), built.tree.primitives.size());
    }
}

TEST(TreeSerialization, RejectsForgeries) {
    const Built built(ball(24, 5.0f, glm::vec3(0.0f)));
    const Parts good(serialize_tree(built.tree));
    ASSERT_TRUE(deserialize_tree(good.bytes(), built.mesh.data()));
    ASSERT_GT(good.nodes[0] & 15u, 1u);
    struct Forgery {
        const char* name;
        std::function<void(Parts&)> change;
    };
    const auto leaf_node = [](Parts& parts) -> std::uint32_t& {
        return *std::find_if(parts.nodes.begin(), parts.nodes.end(),
                             [](std::uint32_t word) { return (word & 15u) == 0; });
    };
    const std::vector<Forgery> forgeries{
        {"no nodes", [](Parts& parts) { parts.nodes.clear(); }},
        {"nothing at all", [](Parts& parts) { parts.nodes.clear(), parts.primitives.clear(); }},
        {"nine children", [](Parts& parts) { parts.nodes[0] = (parts.nodes[0] & ~15u) | 9u; }},
        {"a child that is a leaf, too", [](Parts& parts) { parts.nodes[0] |= 1u << 4u; }},
        {"a child more than there is", [](Parts& parts) { ++parts.nodes[0]; }},
        {"a node without a parent", [](Parts& parts) { parts.nodes.push_back(0); }},
        {"a triangle more than there is", [&](Parts& parts) { leaf_node(parts) |= 3u << 18u; }},
        {"a triangle of no leaf", [&](Parts& parts) { leaf_node(parts) &= ~(3u << 4u); }},
        {"a triangle twice", [](Parts& parts) { parts.primitives[3] = parts.primitives[4]; }},
        {"a triangle that is none", [](Parts& parts) { parts.primitives[3] = 1u << 30u; }},
        {"triangles in each other's boxes",
         [](Parts& parts) { std::swap(parts.primitives.front(), parts.primitives.back()); }},
        {"a cost that is no number", [](Parts& parts) { parts.cost = NAN; }},
        {"another cost", [](Parts& parts) { parts.cost *= 1.5; }},
    };
    for (const Forgery& forgery : forgeries) {
        Parts parts = good;
        forgery.change(parts);
        EXPECT_FALSE(deserialize_tree(parts.bytes(), built.mesh.data())) << forgery.name;
    }
}

// Triangles without area cost nothing, wherever they are.
TEST(TreeSerialization, RejectsForgeriesWithTheRightCost) {
    TestMesh mesh;
    mesh.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    mesh.add({0, 0, 0}, {0, 0, 0}, {0, 1, 0});
    mesh.add({0, 0, 0}, {0, 0, 0}, {0, 1, 0});
    const Built built(mesh);
    Parts parts(serialize_tree(built.tree));
    const double two_nodes = 2.0 * built.tree.cost - TraversalCosts{}.triangle;
    const auto is_tree = [&](std::vector<std::uint32_t> nodes, std::vector<std::uint32_t> primitives) {
        parts.cost = nodes.size() == 1 ? built.tree.cost : two_nodes;
        parts.nodes = std::move(nodes);
        parts.primitives = std::move(primitives);
        return deserialize_tree(parts.bytes(), mesh.data()).has_value();
    };
    const std::uint32_t leaf0 = 1u << 4u, leaf1 = 1u << 6u, two_in_leaf1 = 2u << 6u;
    EXPECT_TRUE(is_tree({leaf0 | two_in_leaf1}, {0, 1, 2}));
    EXPECT_FALSE(is_tree({leaf0 | two_in_leaf1}, {0, 1, 1})) << "one twice";
    EXPECT_FALSE(is_tree({leaf0}, {0, 1})) << "one of no leaf";
    EXPECT_TRUE(is_tree({1u | leaf1, leaf0}, {1, 0}));
    EXPECT_FALSE(is_tree({1u | leaf0, leaf0}, {1, 0})) << "a child that is node and leaf";
}

// The traversal supports eight children.
TEST(TreeSerialization, RejectsNineChildren) {
    CounterRandom random(63);
    for (std::uint32_t children = 9; children < 16; ++children) {
        const Built built(random_mesh(random, children, 1.0f));
        Parts parts(serialize_tree(built.tree));
        parts.nodes.assign(1 + children, 1u << 4u);
        parts.nodes[0] = children;
        EXPECT_FALSE(deserialize_tree(parts.bytes(), built.mesh.data())) << children;
    }
}

TEST(TreeSerialization, RejectsTreesOfOtherMeshes) {
    const Built built(ball(24, 5.0f, glm::vec3(0.0f)));
    const std::vector<std::byte> bytes = serialize_tree(built.tree);
    TestMesh more = built.mesh, fewer = built.mesh, moved = built.mesh;
    more.triangles.push_back(more.triangles.front());
    fewer.triangles.pop_back();
    moved.positions[7].x += 0.01f;
    for (const TestMesh& other : {more, fewer, moved}) EXPECT_FALSE(deserialize_tree(bytes, other.data()));
}

// A chain of nodes, the last with one triangle, as deep as the traversal's stack allows, and one deeper.
TEST(TreeSerialization, RejectsTreesThatAreTooDeep) {
    TestMesh mesh;
    mesh.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const Built built(mesh);
    Parts parts(serialize_tree(built.tree));
    const double as_node = built.tree.cost - TraversalCosts{}.triangle;
    for (const bool fits : {true, false}) {
        const std::uint32_t depth = shading::BvhMeshDepth + (fits ? 0 : 1);
        parts.nodes.assign(depth, 1u);
        parts.nodes.back() = 1u << 4u;
        parts.cost = built.tree.cost + (depth - 1) * as_node;
        const auto tree = deserialize_tree(parts.bytes(), mesh.data());
        EXPECT_EQ(tree.has_value(), fits);
        EXPECT_EQ(tree ? tree->depth : 0, fits ? shading::BvhMeshDepth : 0);
    }
}

}  // namespace

}  // namespace tessera::vulkan
