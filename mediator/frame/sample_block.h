#pragma once

#include <bit>
#include <compare>
#include <cstdint>
#include <tuple>
#include <vector>

namespace tessera::frame {

// An aligned power-of-two range of samples: [first, first + 2^level) with first a multiple of 2^level.
// Two blocks are nested or disjoint.
struct SampleBlock {
    std::uint64_t first = 0;
    std::uint32_t level = 0;

    constexpr std::uint64_t count() const { return std::uint64_t{1} << level; }
    constexpr std::uint64_t end() const { return first + count(); }
    constexpr bool is_aligned() const { return level < 48 && first % count() == 0; }
    constexpr bool contains(const SampleBlock& other) const {
        return first <= other.first && other.end() <= end();
    }
    constexpr SampleBlock sibling() const { return {first ^ count(), level}; }
    constexpr SampleBlock parent() const { return {first & ~count(), level + 1}; }
    friend constexpr auto operator<=>(const SampleBlock&, const SampleBlock&) = default;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "first", &SampleBlock::first), row(2, "level", &SampleBlock::level));
    }
    constexpr const char* malformed() const {
        return is_aligned() ? nullptr : "a block of samples is not aligned";
    }
};

// [first, end) as the fewest aligned blocks, ascending.
inline std::vector<SampleBlock> aligned_blocks(std::uint64_t first, std::uint64_t end) {
    std::vector<SampleBlock> blocks;
    while (first < end) {
        std::uint32_t level = first == 0 ? 47 : static_cast<std::uint32_t>(std::countr_zero(first));
        while (level > 0 && (std::uint64_t{1} << level) > end - first) --level;
        blocks.push_back({first, level});
        first += std::uint64_t{1} << level;
    }
    return blocks;
}

}  // namespace tessera::frame
