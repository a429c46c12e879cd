#pragma once

#include <vulkan/vulkan_core.h>

#include <filesystem>
#include <string>
#include <vector>

#include "backends/vulkan/device/device_list.h"
#include "backends/vulkan/device/handle.h"
#include "backends/vulkan/device/pipeline.h"
#include "mediator/base/disk_cache.h"

namespace tessera::vulkan {

// Compiled kernels on disk, one file each, named by the hash of device, driver and all that the kernel is
// made from. What is damaged or of another driver is compiled anew. Thread-safe.
class PipelineCache final {
  public:
    // An empty folder: nothing is kept.
    PipelineCache(VkDevice device, const DeviceInfo& info, const std::filesystem::path& folder);

    // What vkCreateComputePipelines gives for `info`, which was made from `settings`.
    Handle<VkPipeline, vkDestroyPipeline> make(const VkComputePipelineCreateInfo& info,
                                               const PipelineSettings& settings);

    std::vector<std::string> take_notes() { return files_.take_notes(); }

  private:
    Hash256 key_of(const PipelineSettings& settings) const;

    VkDevice device_;
    const DeviceInfo& info_;
    DiskCache files_;
};

}  // namespace tessera::vulkan
