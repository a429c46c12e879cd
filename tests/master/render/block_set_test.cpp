#include "master/render/schedule/block_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "mediator/base/random.h"

namespace tessera::master {
namespace {

using frame::SampleBlock;

TEST(BlockSet, JoinsSiblingsAndFindsGaps) {
    BlockSet set;
    set.insert({4, 2});
    EXPECT_TRUE(set.covers({6, 1}));
    EXPECT_FALSE(set.covers({0, 3}));
    EXPECT_EQ(set.missing_in({0, 3}), (std::vector<SampleBlock>{{0, 2}}));
    set.insert({0, 1});
    EXPECT_EQ(set.missing_in({0, 3}), (std::vector<SampleBlock>{{2, 1}}));
    set.insert({2, 1});
    EXPECT_TRUE(set.covers({0, 3}));
    EXPECT_EQ(set.sample_count(), 8u);
    set.insert({1, 0});  // inside
    EXPECT_EQ(set.sample_count(), 8u);
}

TEST(BlockSet, AgreesWithAPlainSetOfSamples) {
    CounterRandom random(7);
    for (int round = 0; round < 200; ++round) {
        BlockSet set;
        std::set<std::uint64_t> samples;
        for (int i = 0; i < 30; ++i) {
            const auto level = static_cast<std::uint32_t>(random.below(5));
            const SampleBlock block{random.below(128 >> level) << level, level};
            set.insert(block);
            for (std::uint64_t s = block.first; s < block.end(); ++s) samples.insert(s);
            ASSERT_EQ(set.sample_count(), samples.size());
        }
        std::uint64_t missing = 0;
        for (const SampleBlock& gap : set.missing_in({0, 7})) {
            EXPECT_TRUE(gap.is_aligned());
            for (std::uint64_t s = gap.first; s < gap.end(); ++s) EXPECT_FALSE(samples.contains(s));
            missing += gap.count();
        }
        EXPECT_EQ(missing + samples.size(), 128u);
    }
}

}  // namespace
}  // namespace tessera::master
