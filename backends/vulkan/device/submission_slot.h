#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <vector>

#include "backends/vulkan/device/handle.h"

namespace tessera::vulkan {

// The commands and timestamps of one submission; a later one uses them again.
struct SubmissionSlot {
    SubmissionSlot(VkDevice device, std::uint32_t family);

    void reset();                          // ready to record into
    void make_room(std::uint32_t stamps);  // for that many timestamps, all unset
    // For that many sets with so many descriptors of a kind altogether; those made before are gone.
    void make_room_for_sets(std::uint32_t sets, std::uint32_t storage, std::uint32_t texels);
    std::vector<std::uint64_t> read() const;  // ticks of the stamps, once the device is done

    VkCommandBuffer commands = VK_NULL_HANDLE;
    Handle<VkQueryPool, vkDestroyQueryPool> queries;
    Handle<VkDescriptorPool, vkDestroyDescriptorPool> sets;
    std::uint32_t stamps = 0;  // written by this submission
    std::uint64_t ticket = 0;  // the timeline's value at its end

  private:
    VkDevice device_;
    Handle<VkCommandPool, vkDestroyCommandPool> pool_;
    std::uint32_t stamp_capacity_ = 0, set_capacity_ = 0, storage_capacity_ = 0, texel_capacity_ = 0;
};

}  // namespace tessera::vulkan
