#include "backends/vulkan/device/shader_stage.h"

#include <cstddef>

#include "backends/vulkan/device/result.h"

namespace tessera::vulkan {

ShaderStage::ShaderStage(VkDevice device, const std::string& name, VkShaderStageFlagBits stage,
                         std::span<const std::uint32_t> code, std::span<const Constant> constants)
    : stage_(stage) {
    const VkShaderModuleCreateInfo info{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                        .codeSize = code.size_bytes(),
                                        .pCode = code.data()};
    VkShaderModule object = VK_NULL_HANDLE;
    check(vkCreateShaderModule(device, &info, nullptr, &object),
          "create the shader module of kernel " + name);
    module_ = {device, object};
    for (const Constant& constant : constants) {
        const auto offset =
            static_cast<std::uint32_t>(entries_.size() * sizeof(Constant) + offsetof(Constant, bits));
        entries_.push_back({constant.id, offset, sizeof constant.bits});
    }
    specialization_ = {static_cast<std::uint32_t>(entries_.size()), entries_.data(), constants.size_bytes(),
                       constants.data()};
}

VkPipelineShaderStageCreateInfo ShaderStage::info() const {
    return {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
            .stage = stage_,
            .module = module_.get(),
            .pName = "main",
            .pSpecializationInfo = &specialization_};
}

void check_push_bytes(const std::string& name, std::uint32_t bytes, std::uint32_t allowed) {
    if (bytes <= allowed) return;
    throw Error(ErrorCode::Internal, "kernel " + name + " needs " + std::to_string(bytes) +
                                         " bytes of push constants, but the device's limit is " +
                                         std::to_string(allowed) + "; report this");
}

}  // namespace tessera::vulkan
