#pragma once

#include <vulkan/vulkan_core.h>

#include <span>
#include <string>
#include <vector>

#include "backends/vulkan/device/handle.h"
#include "backends/vulkan/device/pipeline.h"

namespace tessera::vulkan {

// One shader stage of a pipeline under construction: its code and its specialisation constants, which must
// outlive it. Throws Error if the driver rejects the code.
class ShaderStage final {
  public:
    ShaderStage(VkDevice device, const std::string& name, VkShaderStageFlagBits stage,
                std::span<const std::uint32_t> code, std::span<const Constant> constants);
    ShaderStage(const ShaderStage&) = delete;
    ShaderStage& operator=(const ShaderStage&) = delete;

    VkPipelineShaderStageCreateInfo info() const;

  private:
    VkShaderStageFlagBits stage_;
    Handle<VkShaderModule, vkDestroyShaderModule> module_;
    std::vector<VkSpecializationMapEntry> entries_;
    VkSpecializationInfo specialization_{};
};

// Throws Error{Internal} if the push constants are larger than the device allows.
void check_push_bytes(const std::string& name, std::uint32_t bytes, std::uint32_t allowed);

}  // namespace tessera::vulkan
