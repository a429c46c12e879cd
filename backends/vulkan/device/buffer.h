#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "backends/vulkan/device/memory.h"

namespace tessera::vulkan {

class Device;

// Device memory that kernels reach by address (buffer references) and that steps copy and fill. Its end never
// waits: what was submitted before may go on using it, the memory comes back afterwards. The device outlives
// it.
class Buffer final {
  public:
    Buffer() = default;  // of no bytes, at no address
    // Contents undefined. Zero bytes are allowed and have an address. Throws Error{OutOfMemory} with the
    // sizes.
    Buffer(Device& device, std::uint64_t bytes, MemoryKind kind = MemoryKind::Device);
    Buffer(Buffer&& other) noexcept;
    Buffer& operator=(Buffer&& other) noexcept;
    ~Buffer();

    std::uint64_t size() const { return bytes_; }
    VkDeviceAddress address() const { return address_; }
    VkBuffer get() const;
    VkBufferView texels(VkFormat format) const;  // all of it, as whole texels; made at the first call
    // The bytes as the host sees them, for as long as the buffer lives; empty where it cannot see them.
    // Whoever writes or reads here makes sure that no step in flight does; upload() and download() do it for
    // you.
    std::span<std::byte> mapped() const;

  private:
    struct Parts;
    Device* device_ = nullptr;
    std::shared_ptr<Parts> parts_;
    std::uint64_t bytes_ = 0;
    VkDeviceAddress address_ = 0;
};

}  // namespace tessera::vulkan
