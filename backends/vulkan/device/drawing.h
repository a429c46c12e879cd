#pragma once

#include <vulkan/vulkan_core.h>

#include "backends/vulkan/device/device_list.h"
#include "backends/vulkan/device/step.h"

namespace tessera::vulkan {

// The part of the recorder for images and draws. Both checks throw Error{Internal} for an invalid step: an area
// beyond an image, more draws per call than the device supports.
void check_draws(const DrawList& list, const DeviceInfo& info);
void check_copy(const CopyImage& copy);

void record_draws(VkCommandBuffer commands, const DrawList& list);
void record_copy(VkCommandBuffer commands, const CopyImage& copy);
void record_image_initialization(VkCommandBuffer commands, const Image& image);

}  // namespace tessera::vulkan
