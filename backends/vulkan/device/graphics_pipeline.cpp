#include "backends/vulkan/device/graphics_pipeline.h"

#include <array>
#include <span>
#include <utility>

#include "backends/vulkan/device/device.h"
#include "backends/vulkan/device/handle.h"
#include "backends/vulkan/device/image.h"
#include "backends/vulkan/device/result.h"
#include "backends/vulkan/device/shader_stage.h"

namespace tessera::vulkan {

struct GraphicsPipeline::Parts {
    Handle<VkPipelineLayout, vkDestroyPipelineLayout> layout;
    Handle<VkPipeline, vkDestroyPipeline> pipeline;
};

namespace {

// State that all pipelines share: triangles without vertex attributes, two integers per pixel, depth test.
struct FixedState {
    VkPipelineVertexInputStateCreateInfo no_attributes{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    VkPipelineInputAssemblyStateCreateInfo assembly{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    VkPipelineViewportStateCreateInfo viewport{.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
                                               .viewportCount = 1,
                                               .scissorCount = 1};
    VkPipelineRasterizationStateCreateInfo rasterization{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .polygonMode = VK_POLYGON_MODE_FILL,
        .cullMode = VK_CULL_MODE_NONE,
        .lineWidth = 1.0f};
    VkPipelineMultisampleStateCreateInfo samples{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    VkPipelineDepthStencilStateCreateInfo depth{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = VK_TRUE,
        .depthWriteEnable = VK_TRUE,
        .depthCompareOp = VK_COMPARE_OP_GREATER_OR_EQUAL};
    VkPipelineColorBlendAttachmentState both_numbers{.colorWriteMask =
                                                         VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT};
    VkPipelineColorBlendStateCreateInfo blending{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = 1,
        .pAttachments = &both_numbers};
    std::array<VkDynamicState, 2> dynamic_states{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkPipelineDynamicStateCreateInfo dynamic{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
        .dynamicStateCount = static_cast<std::uint32_t>(dynamic_states.size()),
        .pDynamicStates = dynamic_states.data()};
    VkFormat ids = Image::format(Image::Kind::Ids);
    VkPipelineRenderingCreateInfo targets{.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
                                          .colorAttachmentCount = 1,
                                          .pColorAttachmentFormats = &ids,
                                          .depthAttachmentFormat = Image::format(Image::Kind::Depth)};

    FixedState() = default;
    FixedState(const FixedState&) = delete;  // members point to each other
    FixedState& operator=(const FixedState&) = delete;

    // Valid as long as this object and the stages.
    VkGraphicsPipelineCreateInfo info(std::span<const VkPipelineShaderStageCreateInfo> stages,
                                      VkPipelineLayout layout) const {
        return {.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                .pNext = &targets,
                .stageCount = static_cast<std::uint32_t>(stages.size()),
                .pStages = stages.data(),
                .pVertexInputState = &no_attributes,
                .pInputAssemblyState = &assembly,
                .pViewportState = &viewport,
                .pRasterizationState = &rasterization,
                .pMultisampleState = &samples,
                .pDepthStencilState = &depth,
                .pColorBlendState = &blending,
                .pDynamicState = &dynamic,
                .layout = layout};
    }
};

}  // namespace

GraphicsPipeline::GraphicsPipeline(Device& device, const GraphicsSettings& settings)
    : device_(&device),
      parts_(std::make_shared<Parts>()),
      push_bytes_(settings.push_bytes),
      name_(settings.name) {
    const std::uint32_t block = push_bytes_ + static_cast<std::uint32_t>(sizeof(std::uint32_t));
    check_push_bytes(name_, block, device.info().push_constant_bytes);
    const VkPushConstantRange range{VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0, block};
    const VkPipelineLayoutCreateInfo layout_info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                                 .pushConstantRangeCount = 1,
                                                 .pPushConstantRanges = &range};
    VkPipelineLayout layout = VK_NULL_HANDLE;
    check(vkCreatePipelineLayout(device.get(), &layout_info, nullptr, &layout),
          "create the pipeline layout of " + name_);
    parts_->layout = {device.get(), layout};

    const ShaderStage vertex(device.get(), name_, VK_SHADER_STAGE_VERTEX_BIT, settings.vertex,
                             settings.constants);
    const ShaderStage fragment(device.get(), name_, VK_SHADER_STAGE_FRAGMENT_BIT, settings.fragment,
                               settings.constants);
    const std::array stages{vertex.info(), fragment.info()};
    const FixedState fixed;
    parts_->pipeline = device.pipelines().make(fixed.info(stages, layout), settings);
}

GraphicsPipeline& GraphicsPipeline::operator=(GraphicsPipeline&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(parts_, other.parts_);
    std::swap(push_bytes_, other.push_bytes_);
    std::swap(name_, other.name_);
    return *this;
}

GraphicsPipeline::~GraphicsPipeline() {
    if (parts_ != nullptr) device_->queue().retire(std::move(parts_));
}

VkPipeline GraphicsPipeline::get() const {
    return parts_ != nullptr ? parts_->pipeline.get() : VK_NULL_HANDLE;
}

VkPipelineLayout GraphicsPipeline::layout() const {
    return parts_ != nullptr ? parts_->layout.get() : VK_NULL_HANDLE;
}

}  // namespace tessera::vulkan
