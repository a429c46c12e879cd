#include <algorithm>

#include "tests/vulkan/square.comp.h"
#include "tests/vulkan/vulkan_test.h"

// Deliberate faults: that the fixture sees none elsewhere means something only if it sees these.
namespace tessera::vulkan {

namespace {

class ValidationTest : public VulkanTest {
  protected:
    // Whether the layer reported a message with this text in its id; takes all messages.
    bool reported(const std::string& id) {
        const std::vector<Message> messages = take_messages();
        for (const Message& message : messages) seen_ += message.id + "; ";
        return std::any_of(messages.begin(), messages.end(), [&](const Message& message) {
            return message.id.find(id) != std::string::npos || message.text.find(id) != std::string::npos;
        });
    }
    std::string seen_ = "reported: ";
};

TEST_F(ValidationTest, ReportsAnInvalidCall) {
    const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = 0, .usage = 1};
    VkBuffer buffer = VK_NULL_HANDLE;
    vkCreateBuffer(device().get(), &info, nullptr, &buffer);
    vkDestroyBuffer(device().get(), buffer, nullptr);
    EXPECT_TRUE(reported("VUID-VkBufferCreateInfo-size")) << seen_;
}

TEST_F(ValidationTest, ReportsObjectsLeakedAtDeviceDestruction) {
    const VkFenceCreateInfo info{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    VkFence fence = VK_NULL_HANDLE;
    vkCreateFence(device().get(), &info, nullptr, &fence);
    close();
    EXPECT_TRUE(reported("vkDestroyDevice")) << seen_;
}

TEST_F(ValidationTest, ReportsCopiesWithoutABarrier) {
    const Buffer a(device(), 1024), b(device(), 1024), c(device(), 1024);
    const VkCommandPoolCreateInfo pool_info{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    VkCommandPool pool = VK_NULL_HANDLE;
    ASSERT_EQ(vkCreateCommandPool(device().get(), &pool_info, nullptr, &pool), VK_SUCCESS);
    const VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                               .commandPool = pool,
                                               .commandBufferCount = 1};
    VkCommandBuffer commands = VK_NULL_HANDLE;
    vkAllocateCommandBuffers(device().get(), &allocate, &commands);
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    vkBeginCommandBuffer(commands, &begin);
    const VkBufferCopy region{0, 0, 1024};
    vkCmdCopyBuffer(commands, a.get(), b.get(), 1, &region);
    vkCmdCopyBuffer(commands, b.get(), c.get(), 1, &region);
    vkEndCommandBuffer(commands);
    vkDestroyCommandPool(device().get(), pool, nullptr);
    EXPECT_TRUE(reported("SYNC-HAZARD-READ-AFTER-WRITE")) << seen_;
}

TEST_F(ValidationTest, InstrumentationReportsOutOfBoundsAccess) {
    reopen({}, Validation::Instrumented);
    struct Square {
        std::uint64_t numbers;
        std::uint32_t count, first;
    };
    const Buffer numbers(device(), 1024);
    const ComputePipeline kernel(
        device(),
        {.name = "square", .code = shaders::square_comp(), .constants = {{0, 64}}, .push_bytes = 16});
    run(device(), {.pipeline = &kernel,
                   .arguments = Square{numbers.address(), 64, 1 << 20},
                   .groups = {1},
                   .writes = {&numbers}});
    EXPECT_TRUE(reported("out of bounds")) << seen_;
}

}  // namespace

}  // namespace tessera::vulkan
