#include "backends/vulkan/device/buffer.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "backends/vulkan/device/device.h"
#include "backends/vulkan/device/handle.h"
#include "backends/vulkan/device/result.h"

namespace tessera::vulkan {

namespace {

constexpr std::uint64_t LargestTexel =
    16;  // bytes; no buffer is smaller, so that each can be bound as texels

}  // namespace

struct Buffer::Parts {
    Allocation memory;  // outlives the object bound to it
    Handle<VkBuffer, vkDestroyBuffer> object;
    std::mutex mutex;  // protects the views
    std::map<VkFormat, Handle<VkBufferView, vkDestroyBufferView>> views;
};

Buffer::Buffer(Device& device, std::uint64_t bytes, MemoryKind kind)
    : device_(&device), parts_(std::make_shared<Parts>()), bytes_(bytes) {
    if (bytes > device.info().buffer_bytes) {
        throw Error(ErrorCode::OutOfMemory, "cannot create a buffer of " + std::to_string(bytes) +
                                                " bytes: the device's limit is " +
                                                std::to_string(device.info().buffer_bytes) +
                                                " per buffer; use a smaller mesh or texture");
    }
    const VkBufferCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
        .size = std::max(bytes, LargestTexel) + device.buffer_slack(),
        .usage = VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                 VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
                 VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                 VK_BUFFER_USAGE_INDEX_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT,
        .sharingMode = VK_SHARING_MODE_EXCLUSIVE};
    VkBuffer object = VK_NULL_HANDLE;
    check(vkCreateBuffer(device.get(), &info, nullptr, &object), "create a buffer");
    parts_->object = {device.get(), object};
    VkMemoryRequirements needs{};
    vkGetBufferMemoryRequirements(device.get(), object, &needs);
    parts_->memory = device.allocate(needs, kind);
    check(vkBindBufferMemory(device.get(), object, parts_->memory.get(), parts_->memory.offset()),
          "bind memory to a buffer");
    const VkBufferDeviceAddressInfo place{.sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO,
                                          .buffer = object};
    address_ = vkGetBufferDeviceAddress(device.get(), &place);
}

Buffer::Buffer(Buffer&& other) noexcept
    : device_(other.device_),
      parts_(std::move(other.parts_)),
      bytes_(std::exchange(other.bytes_, 0)),
      address_(std::exchange(other.address_, 0)) {}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(parts_, other.parts_);
    std::swap(bytes_, other.bytes_);
    std::swap(address_, other.address_);
    return *this;
}

Buffer::~Buffer() {
    if (parts_ != nullptr) device_->queue().retire(std::move(parts_));
}

VkBuffer Buffer::get() const {
    return parts_ != nullptr ? parts_->object.get() : VK_NULL_HANDLE;
}

VkBufferView Buffer::texels(VkFormat format) const {
    const std::scoped_lock lock(parts_->mutex);
    auto& view = parts_->views[format];
    if (!view) {
        const VkBufferViewCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO,
                                          .buffer = parts_->object.get(),
                                          .format = format,
                                          .range = VK_WHOLE_SIZE};
        VkBufferView object = VK_NULL_HANDLE;
        check(vkCreateBufferView(device_->get(), &info, nullptr, &object), "create a texel view of a buffer");
        view = {device_->get(), object};
    }
    return view.get();
}

std::span<std::byte> Buffer::mapped() const {
    if (parts_ == nullptr || parts_->memory.mapped() == nullptr) return {};
    return {parts_->memory.mapped(), bytes_};
}

}  // namespace tessera::vulkan
