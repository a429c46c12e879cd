#include "master/render/schedule/plan.h"

#include <gtest/gtest.h>

#include <map>

#include "master/render/schedule/block_set.h"
#include "mediator/base/random.h"

namespace tessera::master {
namespace {

using frame::SampleBlock;

TEST(DoublingRounds, CoverEverySampleOnceInAscendingOrder) {
    for (const std::uint64_t spp : {1u, 2u, 3u, 4u, 7u, 64u, 100u, 1000u}) {
        for (const std::uint32_t first_level : {0u, 2u, 5u}) {
            std::uint64_t next = 0;
            for (const SampleBlock& round : doubling_rounds(spp, first_level)) {
                EXPECT_EQ(round.first, next);
                EXPECT_TRUE(round.is_aligned());
                next = round.end();
            }
            EXPECT_EQ(next, spp);
        }
    }
    EXPECT_EQ(doubling_rounds(64, 0).size(), 7u);
    EXPECT_EQ(doubling_rounds(64, 2), (std::vector<SampleBlock>{{0, 2}, {4, 2}, {8, 3}, {16, 4}, {32, 5}}));
}

TEST(TileGrid, CoversTheWindowWithoutGapsOrOverlaps) {
    const Rect window{5, 3, 100, 41};
    std::map<std::pair<int, int>, int> hits;
    for (const Rect& tile : tile_grid(window, 32)) {
        EXPECT_EQ(intersection(tile, window), tile);
        for (int y = tile.y; y < tile.bottom(); ++y) {
            for (int x = tile.x; x < tile.right(); ++x) ++hits[{x, y}];
        }
    }
    EXPECT_EQ(hits.size(), window.pixel_count());
    for (const auto& [pixel, count] : hits) EXPECT_EQ(count, 1);
}

class PlanOf : public testing::TestWithParam<session::Policy> {};

// For any nodes, chunk sizes, returned chunks, and claims that are taken over or given up: every sample of every tile is
// dealt exactly once, net.
TEST_P(PlanOf, DealsEverySampleOnce) {
    CounterRandom random(11);
    for (const std::uint64_t spp : {1u, 5u, 16u, 100u}) {
        Plan plan({.window = {0, 0, 70, 50}, .tile = 32, .spp = spp, .policy = GetParam(), .first_level = 1});
        std::vector<BlockSet> dealt(plan.tiles().size());
        int returns = 20;
        const auto any_node = [&] { return NodeId{1 + random.below(4)}; };
        const auto next = [&]() -> std::optional<Plan::Chunk> {
            const std::uint64_t count = 1 + random.below(40);
            if (auto chunk = plan.next_returned(count, [](const Plan::Chunk&) { return true; })) return chunk;
            return plan.next(any_node(), count, 4, 1 + static_cast<std::uint32_t>(random.below(9)));
        };
        for (int misses = 0; misses < 100;) {
            if (random.below(10) == 0) plan.take_over(any_node(), any_node());
            if (random.below(20) == 0) plan.release_claim(any_node());
            const auto chunk = next();
            if (!chunk) {
                ++misses;  // another node has the last claim
                continue;
            }
            misses = 0;
            EXPECT_TRUE(chunk->block.is_aligned());
            if (returns > 0 && random.below(4) == 0) {
                --returns;
                plan.give_back(*chunk);
                continue;
            }
            EXPECT_TRUE(dealt[chunk->tile].missing_in(chunk->block) == std::vector{chunk->block});
            dealt[chunk->tile].insert(chunk->block);
            if (random.below(50) == 0 && plan.at_round_start()) plan.deal_round_in_eighths();
        }
        EXPECT_TRUE(plan.exhausted());
        EXPECT_EQ(plan.remaining_samples(), 0u);
        for (const BlockSet& tile : dealt) EXPECT_EQ(tile.sample_count(), spp);
    }
}

INSTANTIATE_TEST_SUITE_P(Policies, PlanOf,
                         testing::Values(session::Policy::Tiled, session::Policy::Cooperative,
                                         session::Policy::Mixed));

PlanSettings two_tiles(session::Policy policy) {
    return {.window = {0, 0, 64, 32}, .tile = 32, .spp = 16, .policy = policy, .first_level = 4};
}

TEST(Plan, CooperativeSplitsATileAmongAllNodes) {
    Plan plan(two_tiles(session::Policy::Cooperative));
    const auto first = plan.next(NodeId{1}, 16, 4, 4), second = plan.next(NodeId{2}, 16, 4, 4);
    EXPECT_EQ(first->tile, second->tile);
    EXPECT_EQ(first->block.count(), 4u);
    EXPECT_EQ(second->block.first, 4u);
}

// Else the network would take longer to bring the next one than the node to render it.
TEST(Plan, CooperativeGivesNoNodeLessThanAFifthOfAUnit) {
    Plan plan(two_tiles(session::Policy::Cooperative));
    EXPECT_EQ(plan.next(NodeId{1}, 40, 4, 4)->block.count(), 8u);
    EXPECT_EQ(plan.next(NodeId{2}, 1000, 4, 4)->block, (SampleBlock{8, 3})) << "no more than is left";
    EXPECT_EQ(plan.next(NodeId{3}, 1000, 4, 4)->block.count(), 16u);
}

TEST(Plan, TiledGivesATileToOneNode) {
    Plan plan(two_tiles(session::Policy::Tiled));
    const auto first = plan.next(NodeId{1}, 1000, 4, 4), second = plan.next(NodeId{2}, 1000, 4, 4);
    EXPECT_NE(first->tile, second->tile);
    EXPECT_EQ(first->block.count(), 16u);
}

TEST(Plan, MixedSplitsTilesOnlyWhileThereAreFewerThanWorkers) {
    Plan enough(two_tiles(session::Policy::Mixed)), few(two_tiles(session::Policy::Mixed));
    EXPECT_EQ(enough.next(NodeId{1}, 1000, 2, 2)->block.count(), 16u);
    EXPECT_EQ(few.next(NodeId{1}, 1000, 2, 8)->block.count(), 4u);
}

// A node merges consecutive pieces before it sends them.
TEST(Plan, PiecesOfAClaimAreConsecutive) {
    Plan plan(two_tiles(session::Policy::Mixed));
    const auto tile = plan.next(NodeId{1}, 4, 2, 2)->tile;
    EXPECT_NE(plan.next(NodeId{2}, 4, 2, 2)->tile, tile);
    for (const std::uint64_t first : {4u, 8u, 12u}) {
        const auto piece = plan.next(NodeId{1}, 4, 2, 2);
        EXPECT_EQ(piece->tile, tile);
        EXPECT_EQ(piece->block, (SampleBlock{first, 2}));
    }
}

TEST(Plan, HalfOfAClaimCanBeTakenOver) {
    Plan plan(two_tiles(session::Policy::Tiled));
    (void)plan.next(NodeId{1}, 1, 1, 1);
    plan.take_over(NodeId{2}, NodeId{1});
    EXPECT_EQ(plan.next(NodeId{2}, 1000, 2, 2)->block, (SampleBlock{8, 3}));
    EXPECT_EQ(plan.claims().at(NodeId{1}).end, 8u);
    plan.take_over(NodeId{3}, NodeId{2});  // has nothing left
    EXPECT_FALSE(plan.claims().contains(NodeId{3}));
}

TEST(Plan, AClosedTileGetsNoMoreSamples) {
    Plan plan({.window = {0, 0, 64, 32}, .tile = 32, .spp = 16, .policy = session::Policy::Tiled});
    const auto chunk = plan.next(NodeId{1}, 1, 1, 1);
    plan.give_back(*chunk);
    plan.close_tile(chunk->tile);
    std::uint64_t samples = 0;
    while (const auto next = plan.next(NodeId{1}, 1000, 1, 1)) {
        EXPECT_NE(next->tile, chunk->tile);
        samples += next->block.count();
    }
    EXPECT_EQ(samples, 16u);
    EXPECT_TRUE(plan.exhausted());
    EXPECT_EQ(plan.remaining_samples(), 0u);
}

// Steps of an adaptive plan: each pixel of a mask gets each of its samples once, whatever is given back or taken over.
TEST(Plan, AStepDealsTheSamplesOfItsMasksOnce) {
    CounterRandom random(12);
    Plan plan({.window = {0, 0, 70, 50}, .tile = 32, .spp = 16, .is_adaptive = true});
    const std::size_t tiles = plan.tiles().size();
    std::uint64_t dealt = 0;
    const auto deal_all = [&](std::vector<BlockSet>& sets) {
        for (int misses = 0; misses < 100;) {
            if (random.below(10) == 0)
                plan.take_over(NodeId{1 + random.below(3)}, NodeId{1 + random.below(3)});
            const std::uint64_t count = 1 + random.below(20);
            auto chunk = plan.next_returned(count, [](const Plan::Chunk&) { return true; });
            if (!chunk) chunk = plan.next(NodeId{1 + random.below(3)}, count, 3, 6);
            if (!chunk) {
                ++misses;
                continue;
            }
            misses = 0;
            const RoundMask* mask = plan.mask(chunk->tile, chunk->block.first);
            if (mask != nullptr) ASSERT_GT(mask->pixels, 0u);
            if (random.below(6) == 0) {
                plan.give_back(*chunk);
                continue;
            }
            EXPECT_TRUE(sets[chunk->tile].missing_in(chunk->block) == std::vector{chunk->block});
            sets[chunk->tile].insert(chunk->block);
            dealt += chunk->block.count() *
                     (mask != nullptr ? mask->pixels : plan.tiles()[chunk->tile].pixel_count());
        }
        EXPECT_TRUE(plan.paused());
        EXPECT_FALSE(plan.exhausted());
        EXPECT_EQ(plan.remaining_samples(), 0u);
    };
    std::vector<BlockSet> base(tiles);
    deal_all(base);
    EXPECT_EQ(dealt, 70u * 50u * 16u);
    for (std::uint32_t step = 0; step < 5; ++step) {
        std::vector<Round> rounds;
        std::uint64_t expected = 0;
        for (std::uint32_t level = 4; level <= 4 + step; ++level) {
            std::vector<RoundMask> masks(tiles);
            for (RoundMask& mask : masks) {
                if (random.below(3) == 0) continue;
                mask = {"bits", static_cast<std::uint32_t>(1 + random.below(100))};
                expected += mask.pixels * (std::uint64_t{1} << level);
            }
            rounds.push_back({{std::uint64_t{1} << level, level},
                              std::make_shared<const std::vector<RoundMask>>(std::move(masks))});
        }
        plan.begin_step(rounds);
        EXPECT_EQ(plan.remaining_samples(), expected);
        dealt = 0;
        std::vector<BlockSet> sets(tiles);
        deal_all(sets);
        EXPECT_EQ(dealt, expected);
        for (std::uint32_t tile = 0; tile < tiles; ++tile) {
            std::uint64_t samples = 0;
            for (const Round& round : rounds)
                samples += (*round.masks)[tile].pixels > 0 ? round.block.count() : 0;
            EXPECT_EQ(sets[tile].sample_count(), samples);
        }
    }
    plan.finish_steps();
    EXPECT_TRUE(plan.exhausted());
}

TEST(Plan, UnitsOfFewPixelsHaveMoreSamples) {
    Plan plan({.window = {0, 0, 32, 32}, .tile = 32, .spp = 16, .is_adaptive = true});
    while (plan.next(NodeId{1}, 16, 1, 1)) {
    }
    plan.begin_step({{{256, 8}, std::make_shared<const std::vector<RoundMask>>(1, RoundMask{"bits", 64})}});
    EXPECT_EQ(plan.next(NodeId{1}, 4, 1, 1)->block.count(), 64u) << "a sixteenth of the pixels";
}

TEST(Plan, ARoundInEighthsDealsAllTilesOfOneEighthFirst) {
    Plan plan(two_tiles(session::Policy::Tiled));
    ASSERT_TRUE(plan.at_round_start());
    EXPECT_EQ(plan.round_samples(), 64u * 32u * 16u);
    plan.deal_round_in_eighths();
    EXPECT_EQ(plan.next(NodeId{1}, 1000, 1, 1)->block, (SampleBlock{0, 1}));
    EXPECT_EQ(plan.next(NodeId{1}, 1000, 1, 1)->block, (SampleBlock{0, 1}));
    EXPECT_EQ(plan.next(NodeId{1}, 1000, 1, 1)->block, (SampleBlock{2, 1}));
}

}  // namespace
}  // namespace tessera::master
