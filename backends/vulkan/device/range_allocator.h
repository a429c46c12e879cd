#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace tessera::vulkan {

// A best-fit allocator of ranges of [0, size), so that freed ranges are reused by equal sizes; adjacent holes are
// merged. Logarithmic time, except for alignments that few holes satisfy.
class RangeAllocator final {
  public:
    explicit RangeAllocator(std::uint64_t size);

    // The offset, a multiple of `alignment` (a power of two); nothing if no hole fits. `size` above zero.
    std::optional<std::uint64_t> allocate(std::uint64_t size, std::uint64_t alignment);
    // Releases a range from allocate(), with the same size, once.
    void release(std::uint64_t offset, std::uint64_t size);

    std::uint64_t size() const { return size_; }
    std::uint64_t free_bytes() const { return free_; }
    bool empty() const { return free_ == size_; }

  private:
    void add_hole(std::uint64_t offset, std::uint64_t size);
    void remove_hole(std::map<std::uint64_t, std::uint64_t>::iterator hole);

    std::uint64_t size_, free_ = 0;
    std::map<std::uint64_t, std::uint64_t> holes_;               // offset -> size; no two touch
    std::set<std::pair<std::uint64_t, std::uint64_t>> by_size_;  // the same as (size, offset)
};

}  // namespace tessera::vulkan
