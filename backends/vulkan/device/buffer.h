#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "backends/vulkan/device/memory.h"

namespace tessera::vulkan {

class Device;

// Device memory that kernels access by address (buffer references) and that steps copy and fill. Destruction
// never waits: steps submitted before may still use it; the memory is freed after them. The device outlives it.
class Buffer final {
  public:
    Buffer() = default;  // empty, without address
    // Contents are undefined. Zero bytes are allowed and have an address. Throws Error{OutOfMemory} with the
    // sizes.
    Buffer(Device& device, std::uint64_t bytes, MemoryKind kind = MemoryKind::Device);
    Buffer(Buffer&& other) noexcept;
    Buffer& operator=(Buffer&& other) noexcept;
    ~Buffer();

    std::uint64_t size() const { return bytes_; }
    VkDeviceAddress address() const { return address_; }
    VkBuffer get() const;
    VkBufferView texels(VkFormat format) const;  // of the whole buffer; created by the first call
    // The mapped bytes, valid for the lifetime of the buffer; empty if it is not host-visible. The caller must
    // ensure that no step in flight accesses them; upload() and download() do.
    std::span<std::byte> mapped() const;

  private:
    struct Parts;
    Device* device_ = nullptr;
    std::shared_ptr<Parts> parts_;
    std::uint64_t bytes_ = 0;
    VkDeviceAddress address_ = 0;
};

}  // namespace tessera::vulkan
