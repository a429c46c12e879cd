#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "backends/vulkan/device/buffer.h"

namespace tessera::vulkan {

// A host array mirrored on the device: only the changed part is uploaded.
class DeviceTable final {
  public:
    explicit DeviceTable(Device& device) : device_(device) {}

    // Copies these bytes to the buffer. A different size allocates a new buffer at a new address. Throws
    // Error{OutOfMemory} and DeviceLost; the contents of the buffer are undefined then.
    void update(std::span<const std::byte> bytes);
    template <class T>
    void update(const std::vector<T>& values) {
        update(std::as_bytes(std::span(values)));
    }

    const Buffer& buffer() const { return buffer_; }
    VkDeviceAddress address() const { return buffer_.address(); }

  private:
    Device& device_;
    Buffer buffer_;
    std::vector<std::byte> content_;
};

}  // namespace tessera::vulkan
