#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <span>

#include "backends/vulkan/device/device_list.h"
#include "backends/vulkan/device/pipeline.h"
#include "backends/vulkan/device/step.h"

namespace tessera::vulkan {

// Bytes of one texel; throws Error{Internal} for a format that no kernel reads.
std::uint32_t texel_bytes(VkFormat format);

// Throws Error{Internal} unless the pass binds one buffer for each binding of its pipeline, each within the
// device's limits.
void check_bindings(const Pass& pass, const DeviceInfo& info);

struct BindingCount {
    std::uint32_t sets = 0, storage = 0, texels = 0;
};
BindingCount count_bindings(std::span<const Step> steps);

// A set of the pool, which has room, with what the pass binds; null when that is nothing.
VkDescriptorSet make_set(VkDevice device, VkDescriptorPool pool, const Pass& pass);

}  // namespace tessera::vulkan
