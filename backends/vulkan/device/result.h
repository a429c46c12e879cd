#pragma once

#include <vulkan/vulkan_core.h>

#include <string>
#include <string_view>

#include "mediator/base/error.h"

namespace tessera::vulkan {

// The device is gone and everything on it: destroy all that belongs to its Device and make a new one.
class DeviceLost final : public Error {
  public:
    explicit DeviceLost(const std::string& message) : Error(ErrorCode::Unavailable, message) {}
};

// "VK_ERROR_DEVICE_LOST"; "VkResult -1000" for what this header does not know.
std::string result_name(VkResult result);

// Throws unless VK_SUCCESS: DeviceLost, or Error of the fitting code. `operation` is a phrase that goes on
// from "cannot": check(vkCreateFence(...), "make a fence") gives "cannot make a fence: VK_ERROR_...;
// <remedy>".
void check(VkResult result, std::string_view operation);

}  // namespace tessera::vulkan
