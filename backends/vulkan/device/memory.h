#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <cstdint>

#include "backends/vulkan/device/device_list.h"

namespace tessera::vulkan {

enum class MemoryKind {
    Device,   // where kernels are fastest; mapped only where the device's memory is the host's (unified)
    Upload,   // mapped, written by the host in order
    Readback  // mapped, read by the host
};

class Memory;

// A piece of device memory, given back with its owner.
class Allocation final {
  public:
    Allocation() = default;
    Allocation(Memory& memory, VkDeviceMemory object, std::byte* mapped, std::uint64_t size);
    Allocation(Allocation&& other) noexcept;
    Allocation& operator=(Allocation&& other) noexcept;
    ~Allocation();

    VkDeviceMemory get() const { return object_; }
    std::uint64_t offset() const { return 0; }
    std::byte* mapped() const { return mapped_; }  // null: the host cannot see it

  private:
    Memory* memory_ = nullptr;
    VkDeviceMemory object_ = VK_NULL_HANDLE;
    std::byte* mapped_ = nullptr;
    std::uint64_t size_ = 0;
};

// All memory of a device. Thread-safe; outlives its allocations.
class Memory final {
  public:
    Memory(VkDevice device, const DeviceInfo& info);
    Memory(const Memory&) = delete;
    Memory& operator=(const Memory&) = delete;

    // Throws Error{OutOfMemory} with the sizes.
    Allocation allocate(const VkMemoryRequirements& needs, MemoryKind kind);

  private:
    friend class Allocation;
    void release(VkDeviceMemory object);
    std::uint32_t choose_type(std::uint32_t allowed, MemoryKind kind) const;

    VkDevice device_;
    VkPhysicalDeviceMemoryProperties properties_{};
};

}  // namespace tessera::vulkan
