#include "backends/vulkan/device/submission_slot.h"

#include <algorithm>
#include <array>
#include <bit>

#include "backends/vulkan/device/result.h"

namespace tessera::vulkan {

SubmissionSlot::SubmissionSlot(VkDevice device, std::uint32_t family) : device_(device) {
    const VkCommandPoolCreateInfo pool_info{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                            .queueFamilyIndex = family};
    VkCommandPool pool = VK_NULL_HANDLE;
    check(vkCreateCommandPool(device, &pool_info, nullptr, &pool), "create a command pool");
    pool_ = {device, pool};
    const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                           .commandPool = pool,
                                           .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                           .commandBufferCount = 1};
    check(vkAllocateCommandBuffers(device, &info, &commands), "allocate a command buffer");
}

void SubmissionSlot::reset() {
    check(vkResetCommandPool(device_, pool_.get(), 0), "reset a command pool");
    stamps = 0;
}

void SubmissionSlot::reserve_timestamps(std::uint32_t count) {
    if (count > stamp_capacity_) {
        stamp_capacity_ = std::bit_ceil(count);
        const VkQueryPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                         .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                         .queryCount = stamp_capacity_};
        VkQueryPool object = VK_NULL_HANDLE;
        check(vkCreateQueryPool(device_, &info, nullptr, &object), "create a query pool");
        queries = {device_, object};
    }
    vkResetQueryPool(device_, queries.get(), 0, count);
    stamps = count;
}

void SubmissionSlot::reserve_descriptor_sets(std::uint32_t count, std::uint32_t storage,
                                             std::uint32_t texels) {
    if (count == 0) return;
    if (count <= set_capacity_ && storage <= storage_capacity_ && texels <= texel_capacity_) {
        check(vkResetDescriptorPool(device_, sets.get(), 0), "reset a descriptor pool");
        return;
    }
    set_capacity_ = std::max(set_capacity_, std::bit_ceil(count));
    storage_capacity_ = std::max(storage_capacity_, std::bit_ceil(storage));
    texel_capacity_ = std::max(texel_capacity_, std::bit_ceil(texels));
    const std::array<VkDescriptorPoolSize, 2> sizes{
        VkDescriptorPoolSize{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, storage_capacity_},
        VkDescriptorPoolSize{VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, texel_capacity_}};
    const VkDescriptorPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                          .maxSets = set_capacity_,
                                          .poolSizeCount = static_cast<std::uint32_t>(sizes.size()),
                                          .pPoolSizes = sizes.data()};
    VkDescriptorPool object = VK_NULL_HANDLE;
    check(vkCreateDescriptorPool(device_, &info, nullptr, &object), "create a descriptor pool");
    sets = {device_, object};
}

std::vector<std::uint64_t> SubmissionSlot::read() const {
    std::vector<std::uint64_t> ticks(stamps);
    if (stamps == 0) return ticks;
    check(vkGetQueryPoolResults(device_, queries.get(), 0, stamps, ticks.size() * sizeof(std::uint64_t),
                                ticks.data(), sizeof(std::uint64_t),
                                VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
          "read timestamps");
    return ticks;
}

}  // namespace tessera::vulkan
