// Light trees and sampling of them.
#include "mediator/backend/tables/light_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "mediator/base/random.h"
#include "mediator/shading/light_tree.h"
#include "mediator/shading/scaling.h"

namespace tessera::backend {
namespace {

using shading::Receiver;
using std::numbers::pi;

glm::dvec3 direction(CounterRandom& random) {
    const double z = 2.0 * random.uniform() - 1.0, phi = 2.0 * pi * random.uniform();
    const double r = std::sqrt(1.0 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

enum class Kind { Panels, Bulbs, Spots, All };

// Emitters in a cube of an edge.
std::vector<LightLeaf> some_leaves(std::size_t count, double edge, Kind kind, std::uint64_t seed) {
    CounterRandom random(seed);
    std::vector<LightLeaf> leaves;
    for (std::uint32_t i = 0; i < count; ++i) {
        const glm::dvec3 position = edge * glm::dvec3(random.uniform(), random.uniform(), random.uniform());
        LightLeaf leaf{
            .low = position, .high = position, .axis = direction(random), .power = random.uniform() + 0.01};
        leaf.emitter = i;
        switch (kind == Kind::All ? Kind(i % 3) : kind) {
            case Kind::Panels:
                leaf.high += 0.02 * edge * glm::dvec3(random.uniform(), random.uniform(), random.uniform());
                leaf.emission_angle = 0.5 * pi;
                leaf.two_sided = i % 4 == 0;
                break;
            case Kind::Bulbs:
                leaf.spread = pi;
                leaf.emission_angle = 0.5 * pi;
                break;
            default:
                leaf.emission_angle = 0.1 + random.uniform();
                break;
        }
        leaves.push_back(leaf);
    }
    return leaves;
}

// A tree and a scene to sample it.
struct Tree {
    explicit Tree(const std::vector<LightLeaf>& leaves) : emitters(leaves.size()) {
        for (shading::Emitter& emitter : emitters) emitter.node = shading::NoLightNode;
        nodes = make_light_tree(leaves, emitters);
        scene.light_nodes.items = nodes.data();
        scene.tree_scale = nodes[0].radius > 0.0f ? shading::unit_scale(nodes[0].radius) : 1.0f;
        scene.features = leaves.size() > 1 ? shading::FeatureLightTree : 0u;
    }
    std::vector<shading::Emitter> emitters;
    std::vector<shading::LightNode> nodes;
    shading::Scene scene{};
};

std::vector<Receiver> receivers(double edge, std::size_t count) {
    CounterRandom random(17);
    std::vector<Receiver> found;
    for (std::size_t i = 0; i < count; ++i) {
        const double far = i % 3 == 0 ? 10.0 : 1.0;
        const glm::vec3 position(edge * far *
                                 glm::dvec3(random.uniform(), random.uniform(), random.uniform()));
        found.push_back({position, i % 4 == 0 ? glm::vec3(0.0f) : glm::vec3(direction(random))});
    }
    return found;
}

class LightTrees : public testing::TestWithParam<std::tuple<int, double, Kind>> {};

TEST_P(LightTrees, ProbabilitiesOfAllLeavesSumToOneAndNoneIsZero) {
    const auto [count, edge, kind] = GetParam();
    const Tree tree(some_leaves(static_cast<std::size_t>(count), edge, kind, 5));
    for (const Receiver& receiver : receivers(edge, 20)) {
        double sum = 0.0;
        for (const shading::Emitter& emitter : tree.emitters) {
            const double probability = shading::leaf_probability(tree.scene, emitter.node, receiver);
            ASSERT_GT(probability, 0.0);
            sum += probability;
        }
        EXPECT_NEAR(sum, 1.0, 1e-5);
    }
}

TEST_P(LightTrees, TheProbabilityOfASampleIsThatOfItsEmitter) {
    const auto [count, edge, kind] = GetParam();
    const Tree tree(some_leaves(static_cast<std::size_t>(count), edge, kind, 6));
    CounterRandom random(7);
    for (const Receiver& receiver : receivers(edge, 200)) {
        const glm::vec2 u(random.uniform() * 0.9999999, random.uniform());
        const shading::ChosenEmitter chosen = shading::choose_emitter(tree.scene, receiver, u);
        ASSERT_LT(chosen.index, tree.emitters.size());
        const std::uint32_t node = tree.emitters[chosen.index].node;
        EXPECT_EQ(tree.nodes[node].link & shading::LightIndexBits, chosen.index);
        EXPECT_NEAR(shading::leaf_probability(tree.scene, node, receiver) / chosen.probability, 1.0, 1e-5);
    }
}

TEST_P(LightTrees, NodesBoundTheirSubtrees) {
    const auto [count, edge, kind] = GetParam();
    const std::vector<LightLeaf> leaves = some_leaves(static_cast<std::size_t>(count), edge, kind, 8);
    const Tree tree(leaves);
    ASSERT_LT(tree.nodes.size(), 2 * leaves.size());
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        const LightLeaf& leaf = leaves[i];
        for (std::uint32_t at = tree.emitters[i].node;; at = tree.nodes[at].parent) {
            const shading::LightNode& node = tree.nodes[at];
            const glm::dvec3 center = node.center;
            for (const glm::dvec3& corner : {leaf.low, leaf.high}) {
                EXPECT_LE(glm::length(corner - center), double(node.radius) * (1.0 + 1e-7));
            }
            const double most = node.cos_spread > -1.0f ? std::acos(double(node.cos_spread)) : pi;
            double apart = std::acos(std::clamp(glm::dot(leaf.axis, glm::dvec3(node.axis)), -1.0, 1.0));
            if ((node.link & shading::LightTwoSided) != 0) {
                if (leaf.spread < pi) apart = std::min(apart, pi - apart);
            } else {
                EXPECT_FALSE(leaf.two_sided);
            }
            EXPECT_LE(std::min(pi, apart + leaf.spread), most + 1e-3);
            EXPECT_LE(leaf.emission_angle, std::acos(double(node.cos_emission_angle)) + 1e-3);
            if (at == 0) break;
        }
    }
    EXPECT_NEAR(tree.nodes[0].power, 1.0, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Emitters, LightTrees,
                         testing::Combine(testing::Values(1, 2, 7, 1000), testing::Values(1.0, 1e-25, 1e18),
                                          testing::Values(Kind::Panels, Kind::Bulbs, Kind::Spots,
                                                          Kind::All)));

// 24 random bits are few for thousands of emitters; all the same the frequencies are right.
TEST(LightTree, SampleFrequenciesMatchTheProbabilities) {
    const Tree tree(some_leaves(300, 1.0, Kind::All, 9));
    const Receiver receiver{{0.3f, 0.4f, 0.5f}, {0.0f, 0.0f, 1.0f}, {}};
    constexpr std::uint32_t Samples = 1u << 20;
    std::vector<double> counts(tree.emitters.size());
    const shading::Sampler numbers{0, 99};
    for (std::uint32_t i = 0; i < Samples; ++i) {
        const glm::vec2 u = shading::sample_pair({i, numbers.seed}, 3);
        ++counts[shading::choose_emitter(tree.scene, receiver, u).index];
    }
    // Pearson's chi-squared over those that are expected often enough, the rest together.
    double chi2 = 0.0, rest_expected = 0.0, rest_found = 0.0, cells = 0.0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        const double expected =
            Samples * double(shading::leaf_probability(tree.scene, tree.emitters[i].node, receiver));
        if (expected < 10.0) {
            rest_expected += expected;
            rest_found += counts[i];
            continue;
        }
        chi2 += (counts[i] - expected) * (counts[i] - expected) / expected;
        ++cells;
    }
    EXPECT_GT(cells, 100.0);
    EXPECT_LE(chi2, cells + 4.0 * std::sqrt(2.0 * cells)) << "stratified samples: less, if anything";
    EXPECT_NEAR(rest_found, rest_expected, 4.0 * std::sqrt(rest_expected) + 1.0);
}

TEST(LightTree, NearEmittersFacingTheReceiverAreMoreLikely) {
    LightLeaf near{
        .low = {0, 0, 1}, .high = {0, 0, 1}, .axis = {0, 0, -1}, .emission_angle = 0.5 * pi, .power = 1.0};
    LightLeaf other = near;
    other.emitter = 1;
    const Receiver receiver{{0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 1.0f}, {}};
    const auto odds = [&] {
        const Tree tree({near, other});
        return shading::leaf_probability(tree.scene, tree.emitters[0].node, receiver) /
               shading::leaf_probability(tree.scene, tree.emitters[1].node, receiver);
    };
    EXPECT_NEAR(odds(), 1.0, 1e-5);
    other.low = other.high = {0, 0, 3};
    EXPECT_NEAR(odds(), 9.0, 1e-4);
    other.low = other.high = {0, 0, 1};
    other.power = 0.25;
    EXPECT_NEAR(odds(), 4.0, 1e-4);
    other.power = 1.0;
    other.axis = glm::normalize(glm::dvec3(1, 0, -1));
    EXPECT_NEAR(odds(), std::sqrt(2.0), 1e-4);
    other.axis = {0, 0, 1};
    EXPECT_NEAR(odds(), 1024.0, 2.0) << "turned away";
    other.two_sided = true;
    EXPECT_NEAR(odds(), 1.0, 1e-5);
    other.low = other.high = {0, 0, -1};
    EXPECT_NEAR(odds(), 1024.0, 2.0) << "below the receiver's horizon";
    other = {.low = {0, 0, 1},
             .high = {0, 0, 1},
             .axis = {0.5, 0, -std::sqrt(0.75)},
             .emission_angle = 0.4,
             .power = 1.0};
    other.emitter = 1;
    EXPECT_NEAR(odds(), 1024.0, 2.0) << "a spot light whose cone does not contain it";
    other.emission_angle = 0.6;
    EXPECT_NEAR(odds(), 1.0 / std::sqrt(0.75), 1e-4);
}

TEST(LightTree, KeepsAllEmittersAtOnePositionAndOnALongLine) {
    for (const double factor : {0.0, 0.5}) {
        std::vector<LightLeaf> leaves;
        double position = 1.0;
        for (std::uint32_t i = 0; i < 1000; ++i, position *= factor) {
            leaves.push_back({.low = {position, 0, 0}, .high = {position, 0, 0}, .spread = pi, .power = 1.0});
            leaves.back().emitter = i;
        }
        const Tree tree(leaves);
        std::uint32_t deepest = 0;
        for (const shading::Emitter& emitter : tree.emitters) {
            ASSERT_NE(emitter.node, shading::NoLightNode);
            std::uint32_t depth = 0;
            for (std::uint32_t at = emitter.node; at != 0; at = tree.nodes[at].parent) ++depth;
            deepest = std::max(deepest, depth);
        }
        EXPECT_LE(deepest, 40u);
    }
}

TEST(LightTree, IsTheSameForTheSameLeaves) {
    const auto leaves = some_leaves(2000, 1.0, Kind::All, 10);
    const Tree a(leaves), b(leaves);
    ASSERT_EQ(a.nodes.size(), b.nodes.size());
    EXPECT_EQ(std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(a.nodes[0])), 0);
}

}  // namespace
}  // namespace tessera::backend
