#include "mediator/frame/block_forest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "mediator/frame/block_stack.h"
#include "tests/frame/film_fixture.h"

namespace tessera::frame {
namespace {

using Outcome = BlockForest::Outcome;

// A random cut of [0, spp) into aligned blocks.
std::vector<SampleBlock> random_partition(std::uint64_t spp, CounterRandom& random) {
    std::vector<SampleBlock> blocks = aligned_blocks(0, spp);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        while (blocks[i].level > 0 && random.below(3) != 0) {
            --blocks[i].level;
            blocks.push_back(blocks[i].sibling());
        }
    }
    return blocks;
}

template <class T>
void shuffle(std::vector<T>& values, CounterRandom& random) {
    for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[random.below(i)]);
}

TEST(BlockForest, GivesTheSameBitsForAnyCutOrderAndDuplication) {
    CounterRandom random(1);
    for (const std::uint64_t spp : {1u, 2u, 7u, 16u, 45u}) {
        BlockForest reference;
        for (std::uint64_t i = 0; i < spp; ++i) reference.insert(sample_film(i));
        for (int round = 0; round < 25; ++round) {
            std::vector<SampleBlock> blocks = random_partition(spp, random);
            const std::size_t distinct = blocks.size();
            for (std::size_t i = 0; i < distinct; ++i) {
                if (random.below(3) == 0) blocks.push_back(blocks[i]);
            }
            shuffle(blocks, random);
            BlockForest forest;
            for (const SampleBlock& block : blocks) {
                EXPECT_NE(forest.insert(canonical_film(block)), Outcome::Conflict);
            }
            EXPECT_TRUE(forest.missing(spp).empty());
            EXPECT_EQ(forest.sample_count(), spp);
            EXPECT_EQ(forest.roots(), reference.roots());
            EXPECT_TRUE(identical_bits(forest.merged(), reference.merged()));
        }
    }
}

TEST(BlockForest, ReportsDuplicatesAndReplacements) {
    BlockForest forest;
    EXPECT_EQ(forest.insert(canonical_film({0, 2})), Outcome::Merged);
    EXPECT_EQ(forest.insert(canonical_film({2, 1})), Outcome::Duplicate);
    EXPECT_EQ(forest.insert(canonical_film({0, 2})), Outcome::Duplicate);
    EXPECT_EQ(forest.insert(canonical_film({6, 0})), Outcome::Merged);
    EXPECT_EQ(forest.missing(8), (std::vector<SampleBlock>{{4, 1}, {7, 0}}));
    EXPECT_EQ(forest.insert(canonical_film({4, 2})), Outcome::Replaced);
    EXPECT_EQ(forest.roots(), (std::vector<SampleBlock>{{0, 3}}));
    EXPECT_TRUE(identical_bits(forest.merged(), canonical_film({0, 3})));
}

TEST(BlockForest, OtherBitsForTheSameSamplesAreAConflictAndRejected) {
    BlockForest forest;
    forest.insert(canonical_film({0, 1}));
    FilmTile forged = canonical_film({0, 1});
    forged.planes[0] = std::nextafter(forged.planes[0], 1e9f);
    EXPECT_EQ(forest.insert(forged), Outcome::Conflict);
    EXPECT_TRUE(identical_bits(forest.merged(), canonical_film({0, 1})));
}

TEST(BlockStack, HoldsMaximalAlignedBlocks) {
    BlockStack stack;
    for (std::uint64_t i = 0; i < 11; ++i) {
        FilmTile tile = stack.recycled(SmallTile, {i, 0}, SomeChannels);
        const FilmTile film = sample_film(i);
        tile.counts = film.counts;
        tile.planes = film.planes;
        tile.nonfinite_samples = film.nonfinite_samples;
        stack.push(std::move(tile));
    }
    const std::vector<FilmTile> blocks = stack.take();
    ASSERT_EQ(blocks.size(), 3u);
    const std::array<SampleBlock, 3> expected{{{0, 3}, {8, 1}, {10, 0}}};
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        EXPECT_EQ(blocks[i].block, expected[i]);
        EXPECT_TRUE(identical_bits(blocks[i], canonical_film(expected[i])));
    }
    EXPECT_TRUE(stack.take().empty());
}

}  // namespace
}  // namespace tessera::frame
