#pragma once

#include <vulkan/vulkan_core.h>

#include <functional>

namespace tessera::vulkan {

// Fault injection for tests: called before each call of this kind; a result other than VK_SUCCESS replaces the
// result of the call. Thread-safe.
enum class FaultPoint { Submit, Wait };
using FaultHook = std::function<VkResult(FaultPoint)>;

}  // namespace tessera::vulkan
