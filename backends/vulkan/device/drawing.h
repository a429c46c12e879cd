#pragma once

#include <vulkan/vulkan_core.h>

#include "backends/vulkan/device/device_list.h"
#include "backends/vulkan/device/step.h"

namespace tessera::vulkan {

// The recorder's part for images. Both checks throw Error{Internal} for a step that is none: an area beyond
// an image, more draws a call than the device makes.
void check_draws(const DrawList& list, const DeviceInfo& info);
void check_copy(const CopyImage& copy);

void record_draws(VkCommandBuffer commands, const DrawList& list);
void record_copy(VkCommandBuffer commands, const CopyImage& copy);
void record_preparation(VkCommandBuffer commands, const Image& image);

}  // namespace tessera::vulkan
