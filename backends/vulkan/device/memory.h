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
    Device,   // where kernels are fastest; mapped only where the device's memory is the host's (unified)
    Upload,   // mapped, written by the host in order
    Readback  // mapped, read by the host
};

struct MemorySettings {
    // Bytes that may be taken from each heap of the device; 0 = all that the driver lends. It can only lower.
    std::uint64_t limit = 0;
    // Apart: the host does not look into memory of kind Device even where it could, so that a unified device
    // works like a card of its own.
    enum class Mapping { AsOffered, Apart } mapping = Mapping::AsOffered;
};

// One heap of the device.
struct HeapUse {
    bool device_local = false;
    std::uint64_t used = 0;       // bytes that allocations hold
    std::uint64_t reserved = 0;   // bytes taken from the driver
    std::uint64_t available = 0;  // bytes that could be taken besides
};

class Memory;
struct MemoryBlock;

// A piece of device memory, given back with its owner.
class Allocation final {
  public:
    Allocation() = default;
    Allocation(Allocation&& other) noexcept;
    Allocation& operator=(Allocation&& other) noexcept;
    ~Allocation();

    VkDeviceMemory get() const;
    std::uint64_t offset() const { return offset_; }
    std::byte* mapped() const;  // null: the host cannot see it

  private:
    friend class Memory;
    Memory* memory_ = nullptr;
    MemoryBlock* block_ = nullptr;
    std::uint64_t offset_ = 0, size_ = 0;
};

// All memory of a device for buffers, parts of large blocks that are mapped for good where the host can see
// them. Blocks without allocations go back to the driver, but for one of each kind. Thread-safe; outlives its
// allocations.
class Memory final {
  public:
    Memory(VkDevice device, const DeviceInfo& info, const MemorySettings& settings);
    ~Memory();
    Memory(const Memory&) = delete;
    Memory& operator=(const Memory&) = delete;

    // Throws Error{OutOfMemory} with the bytes asked for, used and available.
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
    std::vector<HeapUse> heaps_;  // `available` is asked for when needed
};

}  // namespace tessera::vulkan
