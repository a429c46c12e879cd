#pragma once

#include <vulkan/vulkan_core.h>

#include <functional>

namespace tessera::vulkan {

// Where a test can make a device fail: called before each call of this kind; what it returns instead of
// VK_SUCCESS counts as the call's result. Thread-safe.
enum class FaultPoint { Submit, Wait };
using FaultHook = std::function<VkResult(FaultPoint)>;

}  // namespace tessera::vulkan
