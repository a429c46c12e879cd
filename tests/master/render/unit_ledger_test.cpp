// Which film is admitted from which node, and how units end.
#include "master/render/schedule/unit_ledger.h"

#include <gtest/gtest.h>

#include "mediator/base/random.h"

namespace tessera::master {
namespace {

using frame::SampleBlock;

constexpr Version SceneVersion{1, 1};

struct UnitLedgerTest : testing::Test {
    const std::vector<Rect> tiles{{0, 0, 8, 8}, {8, 0, 8, 8}};
    const NodeId A{1}, B{2}, C{3};
    UnitLedger ledger{tiles, UnitId{100}, 2};

    UnitId deal(NodeId node, std::uint32_t tile, const SampleBlock& block, Version version = SceneVersion) {
        const UnitId id = ledger.next_unit();
        ledger.deal({.id = id, .version = version, .tile = tiles[tile], .block = block}, tile, nullptr, node,
                    {});
        return id;
    }
    Admission admit(NodeId node, UnitId unit, std::uint32_t tile, const SampleBlock& block,
                    Version version = SceneVersion) {
        return ledger.admit(node, {unit, version, tiles[tile], block});
    }
    std::uint64_t ended() const {
        const session::UnitCounts& counts = ledger.counts();
        return counts.merged + counts.duplicate + counts.cancelled + counts.refused + counts.lost;
    }
};

TEST_F(UnitLedgerTest, AdmitsFilmFromTheHolderAlone) {
    const UnitId unit = deal(A, 0, {0, 3});
    EXPECT_EQ(admit(A, unit, 0, {0, 3}).problem, "");
    EXPECT_NE(admit(B, unit, 0, {0, 3}).problem, "") << "another node's unit";
    EXPECT_NE(admit(A, UnitId{99}, 0, {0, 3}).problem, "") << "never dealt";
    EXPECT_NE(admit(A, UnitId{101}, 0, {0, 3}).problem, "") << "never dealt";
    EXPECT_NE(admit(A, unit, 1, {0, 3}).problem, "") << "another tile";
    EXPECT_NE(admit(A, unit, 0, {0, 4}).problem, "") << "a larger block";
    EXPECT_NE(admit(A, unit, 0, {8, 3}).problem, "") << "other samples";
    EXPECT_NE(admit(A, unit, 0, {0, 3}, {1, 2}).problem, "") << "another version";
}

TEST_F(UnitLedgerTest, AdmitsFilmOfTheUnitsPixelsAlone) {
    const std::string mask("\x01\0\0\0\0\0\0\x80", 8), other("\x02\0\0\0\0\0\0\x80", 8);
    const UnitId id = ledger.next_unit();
    ledger.deal({.id = id, .version = SceneVersion, .tile = tiles[0], .block = {8, 3}, .mask = mask}, 0,
                nullptr, A, {});
    const auto problem = [&](const std::string& of) {
        return ledger.admit(A, {id, SceneVersion, tiles[0], {8, 3}, of}).problem;
    };
    EXPECT_NE(problem(""), "");
    EXPECT_NE(problem(other), "");
    EXPECT_EQ(problem(mask), "");
    (void)ledger.arrived(A, 0, {8, 3});
    EXPECT_EQ(ledger.arrived_samples(), 2u * 8u);
}

// The next step deals the same samples of the tile for other pixels.
TEST_F(UnitLedgerTest, FilmOfAnEarlierStepComesTooLate) {
    const UnitId id = deal(A, 0, {8, 3});
    (void)ledger.arrived(A, 0, {8, 3});
    EXPECT_TRUE(ledger.is_idle());
    ledger.begin_step();
    EXPECT_TRUE(ledger.samples(0).blocks().empty());
    const Admission late = admit(A, id, 0, {8, 3});
    EXPECT_EQ(late.problem, "");
    EXPECT_EQ(late.use, Admission::Use::Drop);
    const UnitId again = deal(B, 0, {8, 3});
    EXPECT_EQ(admit(B, again, 0, {8, 3}).use, Admission::Use::Merge);
    (void)ledger.arrived(B, 0, {8, 3});
    EXPECT_EQ(ledger.counts().merged, 2u);
    EXPECT_EQ(ledger.tiles_without_samples(), 1u);
}

TEST_F(UnitLedgerTest, AdmitsThePartsOfAStoppedUnitAndWhatItsUnitsCoverTogether) {
    const UnitId first = deal(A, 0, {0, 2}), second = deal(A, 0, {4, 2});
    EXPECT_EQ(admit(A, first, 0, {0, 1}).problem, "");
    EXPECT_EQ(admit(A, second, 0, {0, 3}).problem, "") << "merged on the node";
    (void)deal(B, 0, {8, 3});
    EXPECT_NE(admit(A, second, 0, {0, 4}).problem, "") << "half of it was dealt to another node";
}

TEST_F(UnitLedgerTest, FilmMayReplaceOnlyPartsOfItsOwnUnits) {
    const UnitId unit = deal(A, 0, {0, 3});
    ASSERT_EQ(admit(A, unit, 0, {0, 2}).problem, "");
    (void)ledger.arrived(A, 0, {0, 2});
    EXPECT_TRUE(ledger.end(unit, A, Fate::Cancelled));
    // The rest is dealt to B; late film of A comes before it.
    ASSERT_EQ(ledger.take_returned().size(), 1u);
    const UnitId rest = deal(B, 0, {4, 2});
    ASSERT_EQ(admit(B, rest, 0, {4, 1}).problem, "");
    (void)ledger.arrived(B, 0, {4, 1});
    const Admission late = admit(A, unit, 0, {0, 3});
    EXPECT_EQ(late.problem, "") << "it held the unit";
    EXPECT_TRUE(late.replaceable.covers({0, 2})) << "its own part";
    EXPECT_FALSE(late.replaceable.covers({4, 1})) << "B's";
}

TEST_F(UnitLedgerTest, LateFilmOfALostUnitIsStillAdmitted) {
    const UnitId unit = deal(A, 0, {0, 2});
    ledger.node_gone({.node = A, .describe = {}});
    EXPECT_EQ(ledger.counts().lost, 1u);
    EXPECT_EQ(admit(A, unit, 0, {0, 2}).problem, "");
    (void)ledger.arrived(A, 0, {0, 2});
    EXPECT_EQ(ledger.arrived_samples(), 4u * 64u);
    EXPECT_EQ(ended(), 1u) << "it ended when it was lost";
}

TEST_F(UnitLedgerTest, TheSecondHolderEndsWhenItConfirms) {
    const UnitId unit = deal(A, 0, {0, 2});
    ledger.deal_again(unit, B, {});
    EXPECT_EQ(admit(B, unit, 0, {0, 2}).problem, "");
    const auto cancelled = ledger.arrived(B, 0, {0, 2});
    ASSERT_EQ(cancelled.size(), 1u);
    EXPECT_EQ(cancelled[0].node, A);
    EXPECT_TRUE(ledger.is_idle()) << "no samples are awaited";
    EXPECT_EQ(ledger.in_flight(), 1u);
    EXPECT_EQ(admit(A, unit, 0, {0, 2}).problem, "") << "it had finished already";
    (void)ledger.arrived(A, 0, {0, 2});
    EXPECT_EQ(ledger.counts().merged, 1u);
    EXPECT_EQ(ledger.counts().duplicate, 1u);
    EXPECT_EQ(ledger.in_flight(), 0u);
}

TEST_F(UnitLedgerTest, AFailureIsTheNodesFaultIfAnotherSucceeds) {
    const UnitId unit = deal(A, 0, {0, 2});
    EXPECT_TRUE(ledger.fail(unit, A, UnitTrouble::Kind::Failed, "device lost"));
    EXPECT_FALSE(ledger.fail(unit, A, UnitTrouble::Kind::Failed, "device lost")) << "it does not hold it";
    EXPECT_EQ(ledger.unexplained_failures(A), 1u);
    const auto returned = ledger.take_returned();
    ASSERT_EQ(returned.size(), 1u);
    EXPECT_FALSE(ledger.is_settled(*returned[0].trouble));
    const UnitId again = ledger.next_unit();
    ledger.deal({.id = again, .version = SceneVersion, .tile = tiles[0], .block = {0, 2}}, 0,
                returned[0].trouble, B, {});
    (void)admit(B, again, 0, {0, 2});
    (void)ledger.arrived(B, 0, {0, 2});
    const auto explained = ledger.take_explained();
    ASSERT_EQ(explained.size(), 1u);
    EXPECT_EQ(explained[0].node, A);
    EXPECT_TRUE(explained[0].is_to_blame);
    EXPECT_EQ(explained[0].message, "device lost");
    EXPECT_EQ(ledger.unexplained_failures(A), 0u);
}

TEST(UnitTrouble, BlamesTheSamplesAfterTwoFailuresOrThreeVanishedNodes) {
    UnitTrouble trouble;
    trouble.add(UnitTrouble::Kind::Failed, NodeId{1}, "no");
    EXPECT_FALSE(trouble.is_settled(2, {}));
    trouble.add(UnitTrouble::Kind::Failed, NodeId{2}, "boom");
    EXPECT_TRUE(trouble.is_settled(2, {}));
    EXPECT_EQ(trouble.message, "boom");
    UnitTrouble lost;
    for (const std::uint64_t node : {1u, 2u}) lost.add(UnitTrouble::Kind::Vanished, NodeId{node}, "gone");
    EXPECT_FALSE(lost.is_settled(2, {})) << "machines that are preempted";
    lost.add(UnitTrouble::Kind::Vanished, NodeId{3}, "gone");
    EXPECT_TRUE(lost.is_settled(2, {}));
    EXPECT_FALSE(lost.is_settled(2, {NodeId{2}})) << "one of them had lost its connection";
    EXPECT_FALSE(lost.has_failed_on(NodeId{3}));
}

TEST_F(UnitLedgerTest, SamplesThatWereRenderedAsTwoProcessesEndedAreToBlame) {
    const TimePoint later = TimePoint{} + std::chrono::seconds(1);
    const auto deal = [&](NodeId node, std::uint32_t tile, std::shared_ptr<const UnitTrouble> trouble) {
        ledger.deal({.id = ledger.next_unit(), .version = Scene, .tile = tiles[tile], .block = {0, 2}}, tile,
                    std::move(trouble), node, {});
    };
    const auto ends = [&](NodeId node, TimePoint now) {
        ledger.node_gone({.node = node, .rendering = 2, .has_ended = true, .now = now, .describe = {}});
        return ledger.take_returned();
    };
    deal(A, 0, nullptr);
    deal(A, 1, nullptr);
    auto lost = ends(A, later);
    ASSERT_EQ(lost.size(), 2u);
    for (const auto& returned : lost) EXPECT_FALSE(ledger.is_settled(*returned.trouble));
    deal(B, 0, lost[0].trouble);
    auto unreceived = ends(B, TimePoint{});
    ASSERT_EQ(unreceived.size(), 1u);
    EXPECT_EQ(unreceived[0].trouble, lost[0].trouble) << "B had ended before";

    deal(B, 0, lost[0].trouble);
    deal(B, 1, lost[1].trouble);
    lost = ends(B, later);
    ASSERT_EQ(lost.size(), 2u);
    for (const auto& returned : lost) {
        EXPECT_FALSE(ledger.is_settled(*returned.trouble)) << "it may have been the other one";
        EXPECT_TRUE(ledger.is_suspect(returned.trouble));
    }
    deal(NodeId{9}, lost[0].tile, lost[0].trouble);
    EXPECT_TRUE(ledger.holds_suspect(NodeId{9}));
    lost = ends(NodeId{9}, later);
    ASSERT_EQ(lost.size(), 1u);
    EXPECT_TRUE(ledger.is_settled(*lost[0].trouble));
}

TEST_F(UnitLedgerTest, SamplesAreNotToBlameAsSoonWhereNodesDieAnyway) {
    const TimePoint later = TimePoint{} + std::chrono::seconds(1);
    const auto ends = [&](std::uint64_t node) {
        ledger.node_gone(
            {.node = NodeId{node}, .rendering = 1, .has_ended = true, .now = later, .describe = {}});
    };
    const auto kills = [&](std::uint64_t node, std::uint32_t tile,
                           std::shared_ptr<const UnitTrouble> trouble) {
        ledger.deal({.id = ledger.next_unit(), .version = Scene, .tile = tiles[tile], .block = {0, 2}}, tile,
                    std::move(trouble), NodeId{node}, {});
        ends(node);
        return ledger.take_returned().at(0).trouble;
    };
    const auto deaths_until_settled = [&](std::uint64_t first, std::uint32_t tile) {
        std::shared_ptr<const UnitTrouble> trouble;
        for (std::uint64_t node = first; node < first + 9; ++node) {
            trouble = kills(node, tile, trouble);
            if (!ledger.is_settled(*trouble)) continue;
            ledger.blame_samples(trouble);
            return node - first + 1;
        }
        return std::uint64_t{0};
    };
    EXPECT_EQ(deaths_until_settled(20, 0), 2u);
    EXPECT_EQ(deaths_until_settled(30, 1), 2u) << "the samples of the other tile explain its losses";
    ends(40);
    EXPECT_EQ(deaths_until_settled(50, 0), 3u);
    for (std::uint64_t node = 60; node < 70; ++node) ends(node);
    EXPECT_EQ(deaths_until_settled(70, 1), 4u);
    for (std::uint64_t node = 60; node < 70; ++node) ledger.came_back(NodeId{node});
    EXPECT_EQ(deaths_until_settled(80, 0), 3u) << "those that are back had only lost their connection";
}

TEST(UnitTrouble, AllowsThatManyCrashes) {
    UnitTrouble trouble;
    for (std::uint64_t node = 1; node < 9; ++node) {
        EXPECT_FALSE(trouble.is_settled(9, {}));
        trouble.add(UnitTrouble::Kind::Killed, NodeId{node}, "gone");
        EXPECT_TRUE(trouble.is_settled(node, {}));
        EXPECT_FALSE(trouble.is_settled(node + 1, {}));
    }
}

TEST_F(UnitLedgerTest, AProcessThatComesBackWasNotKilled) {
    const TimePoint later = TimePoint{} + std::chrono::seconds(1);
    std::shared_ptr<const UnitTrouble> trouble;
    for (std::uint64_t node = 20; node < 26; ++node) {
        ledger.deal({.id = ledger.next_unit(), .version = Scene, .tile = tiles[0], .block = {0, 2}}, 0,
                    trouble, NodeId{node}, {});
        ledger.node_gone(
            {.node = NodeId{node}, .rendering = 1, .has_ended = true, .now = later, .describe = {}});
        trouble = ledger.take_returned().at(0).trouble;
        EXPECT_FALSE(ledger.is_settled(*trouble));
        ledger.came_back(NodeId{node});
    }
}

// Whatever happens in whatever order, every unit dealt to a node ends exactly once, and all samples arrive.
TEST_F(UnitLedgerTest, EveryHoldingEndsExactlyOnce) {
    CounterRandom random(5);
    for (int round = 0; round < 200; ++round) {
        UnitLedger units(tiles, UnitId{1}, 2);
        std::uint64_t dealt = 0;
        std::vector<UnitLedger::Returned> waiting;
        for (const std::uint32_t tile : {0u, 1u}) {
            for (std::uint64_t first = 0; first < 16; first += 4)
                waiting.push_back({tile, {first, 2}, nullptr});
        }
        for (int step = 0; step < 4000 && units.arrived_samples() < 2 * 16 * 64; ++step) {
            const NodeId node{1 + random.below(4)};
            if (!waiting.empty() && random.below(2) == 0) {
                const UnitLedger::Returned chunk = waiting.back();
                waiting.pop_back();
                for (const SampleBlock& gap : units.samples(chunk.tile).missing_in(chunk.block)) {
                    units.deal({.id = units.next_unit(),
                                .version = SceneVersion,
                                .tile = tiles[chunk.tile],
                                .block = gap},
                               chunk.tile, chunk.trouble, node, {});
                    ++dealt;
                }
                continue;
            }
            const std::vector<UnitId> held = units.held_by(node);
            if (held.empty()) continue;
            const UnitId id = held[random.below(held.size())];
            const UnitLedger::Unit unit = *units.find(id);
            switch (random.below(8)) {
                case 0:
                    if (const NodeId other{1 + random.below(4)};
                        !unit.is_covered && !unit.holders.contains(other)) {
                        units.deal_again(id, other, {});
                        ++dealt;
                    }
                    break;
                case 1:
                    units.end(id, node, Fate::Lost);
                    break;
                case 2:
                    units.fail(id, node, UnitTrouble::Kind::Failed, "no");
                    break;
                case 3:
                    units.node_gone({.node = node, .rendering = 2, .describe = {}});
                    break;
                case 4: {  // stopped after its first half
                    const SampleBlock part{unit.unit.block.first,
                                           unit.unit.block.level - (unit.unit.block.level > 0)};
                    ASSERT_EQ(units.admit(node, {id, SceneVersion, unit.unit.tile, part}).problem, "");
                    (void)units.arrived(node, unit.tile, part);
                    units.end(id, node, Fate::Cancelled);
                    break;
                }
                default:
                    ASSERT_EQ(units.admit(node, {id, SceneVersion, unit.unit.tile, unit.unit.block}).problem,
                              "");
                    (void)units.arrived(node, unit.tile, unit.unit.block);
            }
            for (UnitLedger::Returned& returned : units.take_returned())
                waiting.push_back(std::move(returned));
        }
        (void)units.end_all();
        EXPECT_EQ(units.arrived_samples(), 2u * 16u * 64u);
        const session::UnitCounts& counts = units.counts();
        EXPECT_EQ(dealt, counts.merged + counts.duplicate + counts.cancelled + counts.refused + counts.lost);
        EXPECT_EQ(units.in_flight(), 0u);
    }
}

}  // namespace
}  // namespace tessera::master
