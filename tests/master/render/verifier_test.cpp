// Film rendered again by other nodes: who gets it, and what the comparison says.
#include "master/render/verifier.h"

#include <gtest/gtest.h>

namespace tessera::master {
namespace {

using namespace std::chrono_literals;

struct VerifierTest : testing::Test {
    static Verifier::Witness witness(std::uint64_t node, std::uint8_t film) {
        Hash256 hash{};
        hash.bytes[0] = static_cast<std::byte>(film);
        return {NodeId{node}, {"user", "node-" + std::to_string(node)}, hash};
    }
    void add(std::uint64_t node, std::uint8_t film, std::int32_t x = 0) {
        view::View view;
        view.id = Verifier::view_of(ViewId{8});
        verifier.add({.view = std::make_shared<const view::View>(view),
                      .version = {1, 1},
                      .kind = "k",
                      .tile = {x, 0, 8, 8},
                      .block = {0, 2},
                      .verified = UnitId{5}},
                     witness(node, film));
    }
    std::optional<Verifier::Dealt> deal(std::uint64_t node) {
        return verifier.deal(NodeId{node}, [](const Verifier::Task&) { return true; });
    }
    Verifier::Finding answer(std::uint64_t node, std::uint8_t film) {
        const auto dealt = deal(node);
        EXPECT_TRUE(dealt);
        return *verifier.take(dealt->unit.id, witness(node, film));
    }
    Verifier verifier{{.share = 1.0, .patience = 10s}};
};

TEST_F(VerifierTest, AnotherNodeThatAgreesSettlesIt) {
    add(1, 7);
    EXPECT_FALSE(deal(1)) << "it has rendered it itself";
    const auto dealt = deal(2);
    ASSERT_TRUE(dealt);
    EXPECT_TRUE(Verifier::owns(dealt->unit.id));
    EXPECT_EQ(dealt->unit.view, Verifier::view_of(ViewId{8}));
    EXPECT_EQ(Verifier::pass_of(dealt->unit.view), ViewId{8});
    EXPECT_EQ(dealt->unit.block, (frame::SampleBlock{0, 2}));
    EXPECT_FALSE(verifier.take(dealt->unit.id, witness(3, 7))) << "it was not asked";
    EXPECT_EQ(verifier.take(dealt->unit.id, witness(2, 7))->outcome, Verifier::Outcome::Agreed);
    EXPECT_FALSE(verifier.uses(dealt->unit.view));
}

TEST_F(VerifierTest, AThirdNodeDecidesWhichOfTwoIsWrong) {
    for (const std::uint8_t third : {7, 8, 9}) {
        add(1, 7);
        EXPECT_EQ(answer(2, 8).outcome, Verifier::Outcome::Differs);
        EXPECT_FALSE(deal(1) || deal(2));
        const Verifier::Finding finding = answer(3, third);
        if (third == 9) {
            EXPECT_EQ(finding.outcome, Verifier::Outcome::AllDiffer);
            continue;
        }
        EXPECT_EQ(finding.outcome, Verifier::Outcome::OneIsOdd);
        EXPECT_EQ(finding.odd->node, NodeId{third == 7 ? 2u : 1u});
    }
}

TEST_F(VerifierTest, WhatANodeDoesNotAnswerGoesToAnother) {
    add(1, 7);
    const auto dealt = deal(2);
    ASSERT_TRUE(dealt);
    verifier.node_gone(NodeId{2});
    EXPECT_FALSE(deal(2));
    EXPECT_EQ(answer(3, 7).outcome, Verifier::Outcome::Agreed);
    add(1, 7);
    verifier.drop_old(TimePoint{} + 11s);
    EXPECT_FALSE(deal(2)) << "no node took it in time";
}

TEST_F(VerifierTest, ANodeHasOneBlockOfATileAtATime) {
    add(1, 7);
    add(1, 7);
    add(1, 7, 8);
    EXPECT_TRUE(deal(2));
    const auto second = deal(2);
    ASSERT_TRUE(second);
    EXPECT_EQ(second->unit.tile.x, 8);
    EXPECT_FALSE(deal(2));
    EXPECT_EQ(verifier.forget(second->unit.view).size(), 2u);
    EXPECT_FALSE(deal(3));
}

TEST_F(VerifierTest, ChoosesTheShareAtRandom) {
    Verifier some({.share = 0.1, .seed = 3}), none({.share = 0.0});
    int chosen = 0;
    for (int i = 0; i < 10000; ++i) {
        chosen += some.chooses_next() ? 1 : 0;
        EXPECT_FALSE(none.chooses_next());
    }
    EXPECT_NEAR(chosen, 1000, 150);
}

}  // namespace
}  // namespace tessera::master
