#include "backends/vulkan/device/pipeline.h"

#include <utility>

#include "backends/vulkan/device/device.h"
#include "backends/vulkan/device/handle.h"
#include "backends/vulkan/device/result.h"
#include "backends/vulkan/device/shader_stage.h"

namespace tessera::vulkan {

namespace {

VkDescriptorType type_of(Binding::Kind kind) {
    return kind == Binding::Kind::Storage ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER
                                          : VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
}

using SetLayout = Handle<VkDescriptorSetLayout, vkDestroyDescriptorSetLayout>;

SetLayout make_set_layout(VkDevice device, const std::vector<Binding>& bindings) {
    std::vector<VkDescriptorSetLayoutBinding> list;
    for (const Binding& binding : bindings) {
        list.push_back({binding.index, type_of(binding.kind), 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
    }
    const VkDescriptorSetLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                               .bindingCount = static_cast<std::uint32_t>(list.size()),
                                               .pBindings = list.data()};
    VkDescriptorSetLayout object = VK_NULL_HANDLE;
    check(vkCreateDescriptorSetLayout(device, &info, nullptr, &object), "create a descriptor set layout");
    return {device, object};
}

}  // namespace

struct ComputePipeline::Parts {
    SetLayout set_layout;
    Handle<VkPipelineLayout, vkDestroyPipelineLayout> layout;
    Handle<VkPipeline, vkDestroyPipeline> pipeline;
};

ComputePipeline::ComputePipeline(Device& device, const PipelineSettings& settings)
    : device_(&device),
      parts_(std::make_shared<Parts>()),
      push_bytes_(settings.push_bytes),
      bindings_(settings.bindings),
      name_(settings.name) {
    check_push_bytes(name_, settings.push_bytes, device.info().push_constant_bytes);
    if (!bindings_.empty()) parts_->set_layout = make_set_layout(device.get(), bindings_);
    const VkDescriptorSetLayout set_layout = parts_->set_layout.get();
    const VkPushConstantRange range{VK_SHADER_STAGE_COMPUTE_BIT, 0, settings.push_bytes};
    const VkPipelineLayoutCreateInfo layout_info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                                 .setLayoutCount = bindings_.empty() ? 0u : 1u,
                                                 .pSetLayouts = &set_layout,
                                                 .pushConstantRangeCount = settings.push_bytes > 0 ? 1u : 0u,
                                                 .pPushConstantRanges = &range};
    VkPipelineLayout layout = VK_NULL_HANDLE;
    check(vkCreatePipelineLayout(device.get(), &layout_info, nullptr, &layout),
          "create the pipeline layout of kernel " + name_);
    parts_->layout = {device.get(), layout};

    const ShaderStage stage(device.get(), name_, VK_SHADER_STAGE_COMPUTE_BIT, settings.code,
                            settings.constants);
    const VkComputePipelineCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO, .stage = stage.info(), .layout = layout};
    parts_->pipeline = device.pipelines().make(info, settings);
}

ComputePipeline& ComputePipeline::operator=(ComputePipeline&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(parts_, other.parts_);
    std::swap(push_bytes_, other.push_bytes_);
    std::swap(bindings_, other.bindings_);
    std::swap(name_, other.name_);
    return *this;
}

ComputePipeline::~ComputePipeline() {
    if (parts_ != nullptr) device_->queue().retire(std::move(parts_));
}

VkPipeline ComputePipeline::get() const {
    return parts_ != nullptr ? parts_->pipeline.get() : VK_NULL_HANDLE;
}

VkDescriptorSetLayout ComputePipeline::set_layout() const {
    return parts_ != nullptr ? parts_->set_layout.get() : VK_NULL_HANDLE;
}

VkPipelineLayout ComputePipeline::layout() const {
    return parts_ != nullptr ? parts_->layout.get() : VK_NULL_HANDLE;
}

}  // namespace tessera::vulkan
