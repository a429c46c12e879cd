#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "backends/vulkan/device/device_list.h"
#include "backends/vulkan/device/range_allocator.h"

namespace tessera::vulkan {

enum class MemoryKind {
    Device,   // fastest for kernels; mapped only on unified memory
    Upload,   // mapped, written sequentially by the host
    Readback  // mapped, read by the host
};

struct MemorySettings {
    // Maximum bytes to allocate from each heap; 0 = the driver's limit. Can only lower that limit.
    std::uint64_t limit = 0;
    // Separate: memory of kind Device is never mapped, so that a unified device behaves like a discrete one.
    enum class Mapping { Default, Separate } mapping = Mapping::Default;
};

// One heap of the device.
struct HeapUse {
    bool device_local = false;
    std::uint64_t used = 0;       // bytes in allocations
    std::uint64_t reserved = 0;   // bytes allocated from the driver
    std::uint64_t available = 0;  // bytes that could be allocated in addition
};

class Memory;
struct MemoryBlock;

// A range of device memory, released by the destructor.
class Allocation final {
  public:
    Allocation() = default;
    Allocation(Allocation&& other) noexcept;
    Allocation& operator=(Allocation&& other) noexcept;
    ~Allocation();

    VkDeviceMemory get() const;
    std::uint64_t offset() const { return offset_; }
    std::byte* mapped() const;  // null: not host-visible

  private:
    friend class Memory;
    Memory* memory_ = nullptr;
    MemoryBlock* block_ = nullptr;
    std::uint64_t offset_ = 0, size_ = 0;
};

// Suballocates device memory from large blocks, which are persistently mapped if host-visible. Empty blocks are
// returned to the driver, except for one of each kind. Thread-safe; outlives its allocations.
class Memory final {
  public:
    Memory(VkDevice device, const DeviceInfo& info, const MemorySettings& settings);
    ~Memory();
    Memory(const Memory&) = delete;
    Memory& operator=(const Memory&) = delete;

    // Throws Error{OutOfMemory} with the bytes requested, used and available.
    Allocation allocate(const VkMemoryRequirements& needs, MemoryKind kind);

    std::vector<HeapUse> use() const;

  private:
    friend class Allocation;
    using Blocks = std::vector<std::unique_ptr<MemoryBlock>>;

    std::uint32_t choose_type(std::uint32_t allowed, MemoryKind kind) const;
    MemoryBlock& add_block(std::uint32_t type, const VkMemoryRequirements& needs, MemoryKind kind);
    std::uint64_t available(std::uint32_t heap) const;
    void release(MemoryBlock& block, std::uint64_t offset, std::uint64_t size);
    template <class Condition>
    void free_blocks(std::uint32_t type, Condition condition);
    void free_empty_blocks();

    VkDevice device_;
    const DeviceInfo& info_;
    MemorySettings settings_;
    VkPhysicalDeviceMemoryProperties properties_{};

    mutable std::mutex mutex_;    // protects all below
    std::vector<Blocks> blocks_;  // per memory type
    std::vector<HeapUse> heaps_;  // `available` is queried when needed
};

}  // namespace tessera::vulkan
