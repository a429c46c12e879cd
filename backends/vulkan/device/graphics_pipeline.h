#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "backends/vulkan/device/pipeline.h"

namespace tessera::vulkan {

// Draws triangles whose vertices the vertex shader computes from the vertex and instance index alone, without
// back-face culling. Fragments write ids. Depth increases towards the eye; at equal depth the last draw wins.
struct GraphicsSettings {
    std::string name;                                 // for messages
    std::span<const std::uint32_t> vertex, fragment;  // SPIR-V, entry points "main"
    std::vector<Constant> constants;                  // of both
    // Size of the push-constant block of a draw. The shaders get one more word after it: the number of draws of
    // the list before this call, to be added to the instance index.
    std::uint32_t push_bytes = 0;
};

// A graphics pipeline. Destruction never waits, as for buffers. The device, which must support graphics
// (DeviceInfo::draws), outlives it.
class GraphicsPipeline final {
  public:
    GraphicsPipeline() = default;  // cannot draw
    // Throws Error if the driver rejects the code, or if the block exceeds the device's limit.
    GraphicsPipeline(Device& device, const GraphicsSettings& settings);
    GraphicsPipeline(GraphicsPipeline&& other) noexcept = default;
    GraphicsPipeline& operator=(GraphicsPipeline&& other) noexcept;
    ~GraphicsPipeline();

    VkPipeline get() const;
    VkPipelineLayout layout() const;
    std::uint32_t push_bytes() const { return push_bytes_; }
    const std::string& name() const { return name_; }

  private:
    struct Parts;
    Device* device_ = nullptr;
    std::shared_ptr<Parts> parts_;
    std::uint32_t push_bytes_ = 0;
    std::string name_;
};

}  // namespace tessera::vulkan
