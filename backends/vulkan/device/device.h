#pragma once

#include <vulkan/vulkan_core.h>

#include <atomic>
#include <cstdint>
#include <filesystem>

#include "backends/vulkan/device/device_list.h"
#include "backends/vulkan/device/instance.h"
#include "backends/vulkan/device/memory.h"
#include "backends/vulkan/device/pipeline_cache.h"
#include "backends/vulkan/device/queue.h"
#include "backends/vulkan/device/result.h"

namespace tessera::vulkan {

struct DeviceSettings {
    MemorySettings memory;
    std::filesystem::path cache_folder;  // of compiled kernels; empty: none
    FaultHook fault;                     // for tests
    Validation validation = Validation::None;
    MessageListener listener;  // of the validation layer's messages
    // Bytes behind each buffer that nobody uses. GPU-assisted validation takes structs of scalar layout for
    // padded ones (as std430), so that the last of a buffer seems to lie beyond its end.
    std::uint64_t buffer_slack = 0;
};

// One opened device with its memory and its queue. Outlives all buffers and pipelines made on it.
// Thread-safe.
class Device final {
  public:
    // The device is one of list_devices(instance) and was not refused. Throws Error.
    Device(const Instance& instance, const DeviceInfo& info, const DeviceSettings& settings = {});
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    const DeviceInfo& info() const { return info_; }
    VkDevice get() const { return device_.object; }
    Queue& queue() { return queue_; }
    PipelineCache& pipelines() { return pipelines_; }

    std::uint64_t buffer_slack() const { return buffer_slack_; }
    const Memory& memory() const { return memory_; }
    std::uint64_t uploaded_bytes() const { return uploaded_; }      // so far
    void count_upload(std::uint64_t bytes) { uploaded_ += bytes; }  // for upload()

    // For Buffer: waits for the memory of dropped buffers before it throws Error{OutOfMemory} with the sizes.
    Allocation allocate(const VkMemoryRequirements& needs, MemoryKind kind);

  private:
    struct Opened {
        VkDevice object = VK_NULL_HANDLE;
        ~Opened();
    };

    // In the order in which they need each other.
    DeviceInfo info_;
    std::uint64_t buffer_slack_;
    std::uint32_t family_;
    Opened device_;
    Memory memory_;
    Queue queue_;
    PipelineCache pipelines_;
    std::atomic<std::uint64_t> uploaded_ = 0;
};

}  // namespace tessera::vulkan
