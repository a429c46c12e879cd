#include "backends/vulkan/device/drawing.h"

#include <algorithm>
#include <string>

#include "backends/vulkan/device/buffer.h"
#include "backends/vulkan/device/graphics_pipeline.h"
#include "backends/vulkan/device/image.h"
#include "backends/vulkan/device/step_check.h"

namespace tessera::vulkan {

namespace {

constexpr VkShaderStageFlags DrawingStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

void check_area(const Image* image, Image::Kind kind, const Rect& area, const std::string& step) {
    require(image != nullptr && image->get() != VK_NULL_HANDLE, step + " without an image");
    require(image->kind() == kind, step + " with an image of the wrong kind");
    const bool fits = area.x >= 0 && area.y >= 0 && area.width >= 0 && area.height >= 0 &&
                      std::int64_t{area.x} + area.width <= image->width() &&
                      std::int64_t{area.y} + area.height <= image->height();
    require(fits, step + " beyond an image of " + std::to_string(image->width()) + " x " +
                      std::to_string(image->height()) + " pixels");
}

VkRect2D rectangle(const Rect& area) {
    return {{area.x, area.y},
            {static_cast<std::uint32_t>(area.width), static_cast<std::uint32_t>(area.height)}};
}

VkRenderingAttachmentInfo attachment(const Image& image, VkAttachmentLoadOp before) {
    VkRenderingAttachmentInfo info{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                   .imageView = image.view(),
                                   .imageLayout = VK_IMAGE_LAYOUT_GENERAL,
                                   .loadOp = before,
                                   .storeOp = VK_ATTACHMENT_STORE_OP_STORE};
    if (image.kind() == Image::Kind::Ids) info.clearValue.color.uint32[0] = 0xffffffffu;
    return info;
}

}  // namespace

void check_draws(const DrawList& list, const DeviceInfo& info) {
    require(list.pipeline != nullptr && list.pipeline->get() != VK_NULL_HANDLE,
            "a draw list without a pipeline");
    const std::string name = "draws of " + list.pipeline->name();
    require(list.arguments.size() == list.pipeline->push_bytes(),
            name + " take " + std::to_string(list.pipeline->push_bytes()) + " bytes of arguments but got " +
                std::to_string(list.arguments.size()));
    check_area(list.ids, Image::Kind::Ids, list.area, name);
    check_area(list.depth, Image::Kind::Depth, list.area, name);
    require(list.viewport > 0 && list.viewport <= info.image_edge, name + " with an invalid viewport");
    require(
        list.per_call > 0 && list.per_call <= info.draws_per_call,
        name + " with more draws per call than the device's limit of " + std::to_string(info.draws_per_call));
    check_range(list.draws, 0, std::uint64_t{list.count} * sizeof(VkDrawIndirectCommand), name);
    for (const Buffer* buffer : list.reads) check_range(buffer, 0, 0, name);
}

void check_copy(const CopyImage& copy) {
    require(copy.from != nullptr, "a copy without an image");
    check_area(copy.from, copy.from->kind(), copy.area, "a copy");
    const auto width = static_cast<std::uint64_t>(copy.area.width);
    const auto height = static_cast<std::uint64_t>(copy.area.height);
    require(copy.row_pixels == 0 || copy.row_pixels >= width, "a copy of rows into shorter rows");
    const std::uint64_t row = copy.row_pixels == 0 ? width : copy.row_pixels;
    const std::uint64_t pixels = height == 0 ? 0 : (height - 1) * row + width;
    check_range(copy.to, copy.to_offset, pixels * copy.from->pixel_bytes(), "a copy");
    require(copy.to_offset % copy.from->pixel_bytes() == 0, "a copy to an offset off the pixel grid");
}

void record_draws(VkCommandBuffer commands, const DrawList& list) {
    if (list.area.width == 0 || list.area.height == 0) return;
    const VkRenderingAttachmentInfo depth =
        attachment(*list.depth, list.depth_before == DrawList::Depth::Clear ? VK_ATTACHMENT_LOAD_OP_CLEAR
                                                                            : VK_ATTACHMENT_LOAD_OP_LOAD);
    const VkRenderingAttachmentInfo ids = attachment(*list.ids, VK_ATTACHMENT_LOAD_OP_CLEAR);
    const VkRenderingInfo rendering{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                    .renderArea = rectangle(list.area),
                                    .layerCount = 1,
                                    .colorAttachmentCount = 1,
                                    .pColorAttachments = &ids,
                                    .pDepthAttachment = &depth};
    vkCmdBeginRendering(commands, &rendering);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, list.pipeline->get());
    const auto edge = static_cast<float>(list.viewport);
    const VkViewport viewport{0.0f, 0.0f, edge, edge, 0.0f, 1.0f};
    const VkRect2D scissor = rectangle(list.area);
    vkCmdSetViewport(commands, 0, 1, &viewport);
    vkCmdSetScissor(commands, 0, 1, &scissor);
    const VkPipelineLayout layout = list.pipeline->layout();
    if (list.arguments.size() > 0) {
        vkCmdPushConstants(commands, layout, DrawingStages, 0, list.arguments.size(), list.arguments.data());
    }
    constexpr std::uint32_t Stride = sizeof(VkDrawIndirectCommand);
    for (std::uint32_t first = 0; first < list.count; first += list.per_call) {
        vkCmdPushConstants(commands, layout, DrawingStages, list.arguments.size(), sizeof first, &first);
        vkCmdDrawIndirect(commands, list.draws->get(), std::uint64_t{first} * Stride,
                          std::min(list.per_call, list.count - first), Stride);
        if (list.count - first <= list.per_call) break;  // the sum may not fit
    }
    vkCmdEndRendering(commands);
}

void record_copy(VkCommandBuffer commands, const CopyImage& copy) {
    if (copy.area.width == 0 || copy.area.height == 0) return;
    const VkRect2D area = rectangle(copy.area);
    const VkBufferImageCopy region{.bufferOffset = copy.to_offset,
                                   .bufferRowLength = copy.row_pixels,
                                   .imageSubresource = {.aspectMask = copy.from->aspect(), .layerCount = 1},
                                   .imageOffset = {area.offset.x, area.offset.y, 0},
                                   .imageExtent = {area.extent.width, area.extent.height, 1}};
    vkCmdCopyImageToBuffer(commands, copy.from->get(), VK_IMAGE_LAYOUT_GENERAL, copy.to->get(), 1, &region);
}

// After everything, since the previous use of the memory is unknown.
void record_image_initialization(VkCommandBuffer commands, const Image& image) {
    const VkImageMemoryBarrier2 barrier{
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
        .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
        .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT,
        .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
        .newLayout = VK_IMAGE_LAYOUT_GENERAL,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image.get(),
        .subresourceRange = {.aspectMask = image.aspect(), .levelCount = 1, .layerCount = 1}};
    const VkDependencyInfo dependency{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                      .imageMemoryBarrierCount = 1,
                                      .pImageMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(commands, &dependency);
}

}  // namespace tessera::vulkan
