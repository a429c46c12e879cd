#pragma once

#include <vulkan/vulkan_core.h>

#include "backends/vulkan/device/device_list.h"
#include "backends/vulkan/device/result.h"
#include "backends/vulkan/device/memory.h"
#include "backends/vulkan/device/queue.h"

namespace tessera::vulkan {

// One opened device with its memory and its queue. Outlives all buffers and pipelines made on it.
// Thread-safe.
class Device final {
  public:
    // The device is one of list_devices(instance) and was not refused. Throws Error.
    Device(const Instance& instance, const DeviceInfo& info);
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    const DeviceInfo& info() const { return info_; }
    VkDevice get() const { return device_.object; }
    Queue& queue() { return queue_; }

    // Throws Error{OutOfMemory} with the sizes.
    Allocation allocate(const VkMemoryRequirements& needs, MemoryKind kind);

  private:
    // The last to go, after queue and memory.
    struct Opened {
        VkDevice object = VK_NULL_HANDLE;
        ~Opened();
    };

    DeviceInfo info_;
    std::uint32_t family_;
    Opened device_;
    Memory memory_;
    Queue queue_;
};

}  // namespace tessera::vulkan
