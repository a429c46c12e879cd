#pragma once

#include <vulkan/vulkan_core.h>

#include <span>
#include <string>
#include <vector>

#include "backends/vulkan/device/handle.h"
#include "backends/vulkan/device/pipeline.h"

namespace tessera::vulkan {

// One stage of a pipeline that is being made: its code and the values of its constants, which it refers to.
// Throws Error: the driver refuses the code.
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

// Throws Error{Internal} where a block of push constants is larger than the device allows.
void check_push_bytes(const std::string& name, std::uint32_t bytes, std::uint32_t allowed);

}  // namespace tessera::vulkan
