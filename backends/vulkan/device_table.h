#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "backends/vulkan/device/buffer.h"

namespace tessera::vulkan {

// An array of the host mirrored on the device: only what changed is sent.
class DeviceTable final {
  public:
    explicit DeviceTable(Device& device) : device_(device) {}

    // Afterwards the buffer holds these bytes. Another size makes another buffer, at another address. Throws
    // Error{OutOfMemory} and DeviceLost; what is on the device is unknown then.
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
