#include "backends/vulkan/device/range_allocator.h"

#include <iterator>

namespace tessera::vulkan {

RangeAllocator::RangeAllocator(std::uint64_t size) : size_(size) {
    add_hole(0, size);
}

void RangeAllocator::add_hole(std::uint64_t offset, std::uint64_t size) {
    if (size == 0) return;
    holes_.emplace(offset, size);
    by_size_.emplace(size, offset);
    free_ += size;
}

void RangeAllocator::remove_hole(std::map<std::uint64_t, std::uint64_t>::iterator hole) {
    by_size_.erase({hole->second, hole->first});
    free_ -= hole->second;
    holes_.erase(hole);
}

std::optional<std::uint64_t> RangeAllocator::allocate(std::uint64_t size, std::uint64_t alignment) {
    for (auto at = by_size_.lower_bound({size, 0}); at != by_size_.end(); ++at) {
        const auto [hole_size, hole_offset] = *at;
        const std::uint64_t offset = (hole_offset + alignment - 1) & ~(alignment - 1);
        const std::uint64_t before = offset - hole_offset;
        if (before > hole_size || hole_size - before < size) continue;
        remove_hole(holes_.find(hole_offset));
        add_hole(hole_offset, before);
        add_hole(offset + size, hole_size - before - size);
        return offset;
    }
    return std::nullopt;
}

void RangeAllocator::release(std::uint64_t offset, std::uint64_t size) {
    auto next = holes_.lower_bound(offset);
    if (next != holes_.end() && next->first == offset + size) {
        size += next->second;
        const auto joined = next++;
        remove_hole(joined);
    }
    if (next != holes_.begin()) {
        const auto before = std::prev(next);
        if (before->first + before->second == offset) {
            offset = before->first;
            size += before->second;
            remove_hole(before);
        }
    }
    add_hole(offset, size);
}

}  // namespace tessera::vulkan
