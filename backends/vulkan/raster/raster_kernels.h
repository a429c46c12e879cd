#pragma once

#include <map>
#include <memory>
#include <mutex>

#include "backends/vulkan/device/graphics_pipeline.h"
#include "backends/vulkan/device/pipeline.h"

namespace tessera::vulkan {

// The pipelines of the rasteriser on a device, compiled on first use. Thread-safe.
class RasterKernels final {
  public:
    explicit RasterKernels(Device& device);

    // Requires a device with graphics (DeviceInfo::draws).
    struct Set {
        const GraphicsPipeline& draw;
        const ComputePipeline& cull;
        const ComputePipeline& pyramid;
        std::uint32_t group_size;  // invocations of a workgroup
    };
    // For a scene with these features.
    Set find(std::uint32_t features);

  private:
    Device& device_;
    std::uint32_t group_size_;
    std::mutex mutex_;  // protects:
    std::unique_ptr<ComputePipeline> cull_, pyramid_;
    std::map<std::uint32_t, std::unique_ptr<GraphicsPipeline>> draws_;
};

}  // namespace tessera::vulkan
