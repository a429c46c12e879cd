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
    std::filesystem::path cache_folder;  // cache of compiled kernels; empty: no cache
    FaultHook fault;                     // for tests
    Validation validation = Validation::None;
    MessageListener listener;  // of the validation layer's messages
    // Unused bytes after each buffer. GPU-assisted validation assumes std430 padding for structs of scalar
    // layout, so that the last one of a buffer seems to end out of bounds.
    std::uint64_t buffer_slack = 0;
};

// An opened device with its memory and its queue. Outlives all buffers and pipelines created on it.
// Thread-safe.
class Device final {
  public:
    // The device is one of list_devices(instance) and usable (`refused` is empty). Throws Error.
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
    std::uint64_t uploaded_bytes() const { return uploaded_; }      // in total
    void count_upload(std::uint64_t bytes) { uploaded_ += bytes; }  // for upload()

    // For Buffer: waits for the memory of dropped buffers before it throws Error{OutOfMemory} with the sizes.
    Allocation allocate(const VkMemoryRequirements& needs, MemoryKind kind);

  private:
    struct Opened {
        VkDevice object = VK_NULL_HANDLE;
        ~Opened();
    };

    // In order of dependency.
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
