#include "backends/vulkan/device/image.h"

#include <algorithm>
#include <string>
#include <utility>

#include "backends/vulkan/device/device.h"
#include "backends/vulkan/device/handle.h"
#include "backends/vulkan/device/result.h"

namespace tessera::vulkan {

struct Image::Parts {
    Allocation memory;  // outlives the object bound to it
    Handle<VkImage, vkDestroyImage> object;
    Handle<VkImageView, vkDestroyImageView> view;
};

VkFormat Image::format(Kind kind) {
    return kind == Kind::Ids ? VK_FORMAT_R32G32_UINT : VK_FORMAT_D32_SFLOAT;
}

Image::Image(Device& device, Kind kind, std::uint32_t width, std::uint32_t height)
    : device_(&device), parts_(std::make_shared<Parts>()), kind_(kind), width_(width), height_(height) {
    if (std::min(width, height) == 0 || std::max(width, height) > device.info().image_edge) {
        throw Error(ErrorCode::Internal, "cannot create an image of " + std::to_string(width) + " x " +
                                             std::to_string(height) + " pixels: the device's limit is " +
                                             std::to_string(device.info().image_edge) + "; report this");
    }
    const VkImageUsageFlags target =
        kind == Kind::Ids ? VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT : VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
    const VkImageCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                 .imageType = VK_IMAGE_TYPE_2D,
                                 .format = format(kind),
                                 .extent = {width, height, 1},
                                 .mipLevels = 1,
                                 .arrayLayers = 1,
                                 .samples = VK_SAMPLE_COUNT_1_BIT,
                                 .tiling = VK_IMAGE_TILING_OPTIMAL,
                                 .usage = target | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                                 .sharingMode = VK_SHARING_MODE_EXCLUSIVE,
                                 .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED};
    VkImage object = VK_NULL_HANDLE;
    check(vkCreateImage(device.get(), &info, nullptr, &object), "create an image");
    parts_->object = {device.get(), object};

    // Rounded up to whole granules: buffers may be neighbours in the same block.
    VkMemoryRequirements needs{};
    vkGetImageMemoryRequirements(device.get(), object, &needs);
    const std::uint64_t granule = std::max<std::uint64_t>(1, device.info().image_granularity);
    needs.alignment = std::max(needs.alignment, granule);
    needs.size = (needs.size + granule - 1) / granule * granule;
    parts_->memory = device.allocate(needs, MemoryKind::Device);
    check(vkBindImageMemory(device.get(), object, parts_->memory.get(), parts_->memory.offset()),
          "bind memory to an image");

    const VkImageViewCreateInfo view_info{
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = object,
        .viewType = VK_IMAGE_VIEW_TYPE_2D,
        .format = format(kind),
        .subresourceRange = {.aspectMask = aspect(), .levelCount = 1, .layerCount = 1}};
    VkImageView view = VK_NULL_HANDLE;
    check(vkCreateImageView(device.get(), &view_info, nullptr, &view), "create an image view");
    parts_->view = {device.get(), view};
    device.queue().submit(Step(InitializeImage{this}));
}

Image::Image(Image&& other) noexcept
    : device_(other.device_),
      parts_(std::move(other.parts_)),
      kind_(other.kind_),
      width_(std::exchange(other.width_, 0)),
      height_(std::exchange(other.height_, 0)) {}

Image& Image::operator=(Image&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(parts_, other.parts_);
    std::swap(kind_, other.kind_);
    std::swap(width_, other.width_);
    std::swap(height_, other.height_);
    return *this;
}

Image::~Image() {
    if (parts_ != nullptr) device_->queue().retire(std::move(parts_));
}

VkImage Image::get() const {
    return parts_ != nullptr ? parts_->object.get() : VK_NULL_HANDLE;
}

VkImageView Image::view() const {
    return parts_ != nullptr ? parts_->view.get() : VK_NULL_HANDLE;
}

VkImageAspectFlags Image::aspect() const {
    return kind_ == Kind::Ids ? VK_IMAGE_ASPECT_COLOR_BIT : VK_IMAGE_ASPECT_DEPTH_BIT;
}

}  // namespace tessera::vulkan
