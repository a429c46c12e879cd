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

// For any chunk sizes and returned chunks, every sample of every tile is dealt exactly once, net.
TEST_P(PlanOf, DealsEverySampleOnce) {
    CounterRandom random(11);
    for (const std::uint64_t spp : {1u, 5u, 16u, 100u}) {
        Plan plan({.window = {0, 0, 70, 50}, .tile = 32, .spp = spp, .policy = GetParam(), .first_level = 1});
        std::vector<BlockSet> dealt(plan.tiles().size());
        int returns = 20;
        while (const auto chunk =
                   plan.next(1 + random.below(40), 1 + static_cast<std::uint32_t>(random.below(5)))) {
            EXPECT_TRUE(chunk->block.is_aligned());
            if (returns > 0 && random.below(4) == 0) {
                --returns;
                plan.give_back(*chunk);
                continue;
            }
            EXPECT_FALSE(dealt[chunk->tile].covers(chunk->block));
            const std::uint64_t before = dealt[chunk->tile].sample_count();
            dealt[chunk->tile].insert(chunk->block);
            EXPECT_EQ(dealt[chunk->tile].sample_count(), before + chunk->block.count());
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

TEST(Plan, CooperativeSplitsATileAmongAllNodes) {
    Plan plan({.window = {0, 0, 64, 32},
               .tile = 32,
               .spp = 16,
               .policy = session::Policy::Cooperative,
               .first_level = 4});
    const auto first = plan.next(1000, 4), second = plan.next(1000, 4);
    EXPECT_EQ(first->tile, second->tile);
    EXPECT_EQ(first->block.count(), 4u);
    EXPECT_EQ(second->block.first, 4u);
}

TEST(Plan, TiledGivesATileToOneNode) {
    Plan plan({.window = {0, 0, 64, 32},
               .tile = 32,
               .spp = 16,
               .policy = session::Policy::Tiled,
               .first_level = 4});
    const auto first = plan.next(1000, 4), second = plan.next(1000, 4);
    EXPECT_NE(first->tile, second->tile);
    EXPECT_EQ(first->block.count(), 16u);
}

TEST(Plan, ARoundInEighthsDealsAllTilesOfOneEighthFirst) {
    Plan plan({.window = {0, 0, 64, 32},
               .tile = 32,
               .spp = 16,
               .policy = session::Policy::Tiled,
               .first_level = 4});
    ASSERT_TRUE(plan.at_round_start());
    EXPECT_EQ(plan.round_samples(), 64u * 32u * 16u);
    plan.deal_round_in_eighths();
    EXPECT_EQ(plan.next(1000, 1)->block, (SampleBlock{0, 1}));
    EXPECT_EQ(plan.next(1000, 1)->block, (SampleBlock{0, 1}));
    EXPECT_EQ(plan.next(1000, 1)->block, (SampleBlock{2, 1}));
}

}  // namespace
}  // namespace tessera::master
