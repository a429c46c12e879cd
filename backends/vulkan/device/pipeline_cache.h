#pragma once

#include <vulkan/vulkan_core.h>

#include <filesystem>
#include <string>
#include <vector>

#include "backends/vulkan/device/device_list.h"
#include "backends/vulkan/device/graphics_pipeline.h"
#include "backends/vulkan/device/handle.h"
#include "backends/vulkan/device/pipeline.h"
#include "mediator/base/disk_cache.h"

namespace tessera::vulkan {

// A disk cache of compiled kernels, one file each, named by the hash of device, driver and all inputs of the
// compilation. Files that are damaged or of another driver are ignored and recompiled. Thread-safe.
class PipelineCache final {
  public:
    // An empty folder disables the cache.
    PipelineCache(VkDevice device, const DeviceInfo& info, const std::filesystem::path& folder);

    // Compiles `info`, which was built from `settings`, or loads it from the cache.
    Handle<VkPipeline, vkDestroyPipeline> make(const VkComputePipelineCreateInfo& info,
                                               const PipelineSettings& settings);
    Handle<VkPipeline, vkDestroyPipeline> make(const VkGraphicsPipelineCreateInfo& info,
                                               const GraphicsSettings& settings);

    std::vector<std::string> take_notes() { return files_.take_notes(); }

  private:
    void update_with_driver(Blake2b& hash) const;
    // `create` calls the driver with the given cache.
    template <class Create>
    Handle<VkPipeline, vkDestroyPipeline> make(const Hash256& key, const std::string& name,
                                               const Create& create);

    VkDevice device_;
    const DeviceInfo& info_;
    DiskCache files_;
};

}  // namespace tessera::vulkan
