#include "backends/vulkan/device/range_allocator.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace tessera::vulkan {

namespace {

struct Piece {
    std::uint64_t offset, size;
};

TEST(RangeAllocator, RandomRangesNeverOverlapAndAreAllReleased) {
    constexpr std::uint64_t Size = 1 << 20;
    std::mt19937 random(7);
    RangeAllocator ranges(Size);
    std::vector<Piece> pieces;
    std::vector<bool> taken(Size, false);
    std::uint64_t used = 0, refused = 0;
    for (int turn = 0; turn < 20000; ++turn) {
        if (pieces.empty() || random() % 5 < 3) {
            const std::uint64_t size = 1 + random() % (random() % 8 == 0 ? 65536 : 512);
            const std::uint64_t alignment = std::uint64_t(1) << random() % 9;
            const auto offset = ranges.allocate(size, alignment);
            refused += offset ? 0 : 1;
            if (!offset) continue;
            ASSERT_EQ(*offset % alignment, 0u);
            ASSERT_LE(*offset + size, Size);
            for (std::uint64_t i = *offset; i < *offset + size; ++i) {
                ASSERT_FALSE(taken[i]) << "byte " << i;
                taken[i] = true;
            }
            pieces.push_back({*offset, size});
            used += size;
        } else {
            std::swap(pieces[random() % pieces.size()], pieces.back());
            const Piece piece = pieces.back();
            pieces.pop_back();
            ranges.release(piece.offset, piece.size);
            std::fill_n(taken.begin() + static_cast<std::ptrdiff_t>(piece.offset), piece.size, false);
            used -= piece.size;
        }
        ASSERT_EQ(ranges.free_bytes(), Size - used);
    }
    EXPECT_GT(refused, 0u) << "the test never filled the range";
    for (const Piece& piece : pieces) ranges.release(piece.offset, piece.size);
    EXPECT_TRUE(ranges.empty());
    EXPECT_EQ(ranges.allocate(Size, 1), std::optional<std::uint64_t>(0)) << "the holes did not become one";
}

// Repeated replacement by equal sizes, as for vertices of a moving mesh, must not fragment memory.
TEST(RangeAllocator, EqualSizesReuseHoles) {
    RangeAllocator ranges(100 * 1000);
    std::vector<std::uint64_t> offsets;
    for (int i = 0; i < 100; ++i) offsets.push_back(ranges.allocate(1000, 1).value());
    EXPECT_FALSE(ranges.allocate(1, 1));
    std::mt19937 random(3);
    for (int turn = 0; turn < 1000; ++turn) {
        std::uint64_t& offset = offsets[random() % offsets.size()];
        ranges.release(offset, 1000);
        const auto again = ranges.allocate(1000, 1);
        ASSERT_TRUE(again);
        offset = *again;
    }
}

TEST(RangeAllocator, UsesTheSmallestHoleThatFits) {
    RangeAllocator ranges(1000);
    const auto large = ranges.allocate(300, 1), wall = ranges.allocate(10, 1), small = ranges.allocate(50, 1);
    ASSERT_TRUE(large && wall && small && ranges.allocate(640, 1));
    ranges.release(*large, 300);
    ranges.release(*small, 50);
    EXPECT_EQ(ranges.allocate(40, 1), small);
    EXPECT_EQ(ranges.allocate(60, 1), large);
}

}  // namespace

}  // namespace tessera::vulkan
