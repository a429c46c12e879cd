#pragma once

#include <vulkan/vulkan_core.h>

#include <utility>

namespace tessera::vulkan {

// One Vulkan object of a device, destroyed with its owner: Handle<VkBuffer, vkDestroyBuffer>. Empty when
// default-constructed or moved from. The device outlives it.
template <class T, auto Destroy>
class Handle final {
  public:
    Handle() = default;
    Handle(VkDevice device, T object) : device_(device), object_(object) {}
    Handle(Handle&& other) noexcept
        : device_(other.device_), object_(std::exchange(other.object_, VK_NULL_HANDLE)) {}
    Handle& operator=(Handle&& other) noexcept {
        std::swap(device_, other.device_);
        std::swap(object_, other.object_);
        return *this;
    }
    ~Handle() {
        if (object_ != VK_NULL_HANDLE) Destroy(device_, object_, nullptr);
    }

    T get() const { return object_; }
    explicit operator bool() const { return object_ != VK_NULL_HANDLE; }

  private:
    VkDevice device_ = VK_NULL_HANDLE;
    T object_ = VK_NULL_HANDLE;
};

}  // namespace tessera::vulkan
