#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <vector>

#include "backends/vulkan/device/handle.h"

namespace tessera::vulkan {

// Command buffer, timestamps and descriptor sets of one submission; reused by later ones.
struct SubmissionSlot {
    SubmissionSlot(VkDevice device, std::uint32_t family);

    void reset();                                   // prepares for recording
    void reserve_timestamps(std::uint32_t stamps);  // resets this many timestamps
    // Capacity for this many sets with this many descriptors in total; frees previous sets.
    void reserve_descriptor_sets(std::uint32_t sets, std::uint32_t storage, std::uint32_t texels);
    std::vector<std::uint64_t> read() const;  // timestamps in ticks, once the device is done

    VkCommandBuffer commands = VK_NULL_HANDLE;
    Handle<VkQueryPool, vkDestroyQueryPool> queries;
    Handle<VkDescriptorPool, vkDestroyDescriptorPool> sets;
    std::uint32_t stamps = 0;  // written by this submission
    std::uint64_t ticket = 0;  // timeline semaphore value at completion

  private:
    VkDevice device_;
    Handle<VkCommandPool, vkDestroyCommandPool> pool_;
    std::uint32_t stamp_capacity_ = 0, set_capacity_ = 0, storage_capacity_ = 0, texel_capacity_ = 0;
};

}  // namespace tessera::vulkan
