#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "backends/vulkan/device/pipeline.h"

namespace tessera::vulkan {

// How triangles are drawn: three vertices each, made by the vertex shader from the vertex's and the
// instance's index alone; both sides count. Fragments give ids. Depth grows towards the eye; what is as near
// as what is there already takes its place, so that the last of equals stays.
struct GraphicsSettings {
    std::string name;                                 // for messages
    std::span<const std::uint32_t> vertex, fragment;  // SPIR-V, entry points "main"
    std::vector<Constant> constants;                  // of both
    // Of the push-constant block that a draw gives. The shaders see one more word behind it: how many draws
    // of the list are not of this call, to be added to the instance's index.
    std::uint32_t push_bytes = 0;
};

// A pipeline that is ready to draw. Its end never waits, like a buffer's. The device, which draws (see
// DeviceInfo), outlives it.
class GraphicsPipeline final {
  public:
    GraphicsPipeline() = default;  // cannot draw
    // Throws Error: the driver refuses the code, or the block exceeds the device's limit.
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
