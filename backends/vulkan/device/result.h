#pragma once

#include <vulkan/vulkan_core.h>

#include <string>
#include <string_view>

#include "mediator/base/error.h"

namespace tessera::vulkan {

// The device and everything on it is lost: destroy all objects of its Device and open a new one.
class DeviceLost final : public Error {
  public:
    explicit DeviceLost(const std::string& message) : Error(ErrorCode::Unavailable, message) {}
};

// "VK_ERROR_DEVICE_LOST"; "VkResult -1000" for unknown values.
std::string result_name(VkResult result);

// Throws unless VK_SUCCESS: DeviceLost, or Error of the matching code. `operation` is a phrase that follows
// "cannot": check(vkCreateFence(...), "create a fence") gives "cannot create a fence: VK_ERROR_...;
// <remedy>".
void check(VkResult result, std::string_view operation);

}  // namespace tessera::vulkan
