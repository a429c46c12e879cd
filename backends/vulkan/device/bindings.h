#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <span>

#include "backends/vulkan/device/device_list.h"
#include "backends/vulkan/device/pipeline.h"
#include "backends/vulkan/device/step.h"

namespace tessera::vulkan {

// Bytes of one texel; throws Error{Internal} for an unsupported format.
std::uint32_t texel_bytes(VkFormat format);

// Throws Error{Internal} unless the dispatch binds one buffer for each binding of its pipeline, each within the
// device's limits.
void check_bindings(const Dispatch& dispatch, const DeviceInfo& info);

struct BindingCount {
    std::uint32_t sets = 0, storage = 0, texels = 0;
};
BindingCount count_bindings(std::span<const Step> steps);

// A descriptor set with the bound buffers of the dispatch, from a pool with sufficient capacity; null without
// bindings.
VkDescriptorSet make_set(VkDevice device, VkDescriptorPool pool, const Dispatch& dispatch);

}  // namespace tessera::vulkan
