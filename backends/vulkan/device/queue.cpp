#include "backends/vulkan/device/queue.h"

#include <algorithm>
#include <string>
#include <utility>

#include "backends/vulkan/device/buffer.h"
#include "backends/vulkan/device/pipeline.h"
#include "backends/vulkan/device/result.h"

namespace tessera::vulkan {

// What a submission needs, used again by later ones.
struct Submission::Slot {
    Handle<VkCommandPool, vkDestroyCommandPool> pool;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    std::uint64_t ticket = 0;
};

namespace {

void require(bool holds, const std::string& what) {
    if (!holds) throw Error(ErrorCode::Internal, what + "; report this");
}

void check_part(const Buffer* buffer, std::uint64_t offset, std::uint64_t bytes, const char* step) {
    require(buffer != nullptr && buffer->get() != VK_NULL_HANDLE, std::string(step) + " without a buffer");
    require(
        offset <= buffer->size() && bytes <= buffer->size() - offset,
        std::string(step) + " beyond the end of a buffer of " + std::to_string(buffer->size()) + " bytes");
}

void full_barrier(VkCommandBuffer commands) {
    const VkMemoryBarrier2 barrier{
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
        .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
        .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_2_HOST_BIT,
        .dstAccessMask =
            VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT | VK_ACCESS_2_HOST_READ_BIT};
    const VkDependencyInfo dependency{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(commands, &dependency);
}

class Recorder {
  public:
    Recorder(VkCommandBuffer commands, const DeviceInfo& info) : commands_(commands), info_(info) {}

    void operator()(const Pass& pass) const {
        require(pass.pipeline != nullptr && pass.pipeline->get() != VK_NULL_HANDLE,
                "a pass without a pipeline");
        const ComputePipeline& pipeline = *pass.pipeline;
        require(pass.arguments.size() == pipeline.push_bytes(),
                "kernel " + pipeline.name() + " takes " + std::to_string(pipeline.push_bytes()) +
                    " bytes of arguments and got " + std::to_string(pass.arguments.size()));
        const Groups& groups = pass.groups;
        require(std::max({groups.x, groups.y, groups.z}) <= info_.max_groups,
                "kernel " + pipeline.name() + " has more groups along an axis than the device's " +
                    std::to_string(info_.max_groups));
        vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.get());
        if (pass.arguments.size() > 0) {
            vkCmdPushConstants(commands_, pipeline.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                               pass.arguments.size(), pass.arguments.data());
        }
        vkCmdDispatch(commands_, groups.x, groups.y, groups.z);
    }

    void operator()(const Copy& copy) const {
        check_part(copy.from, copy.from_offset, copy.bytes, "a copy");
        check_part(copy.to, copy.to_offset, copy.bytes, "a copy");
        if (copy.bytes == 0) return;
        const VkBufferCopy region{copy.from_offset, copy.to_offset, copy.bytes};
        vkCmdCopyBuffer(commands_, copy.from->get(), copy.to->get(), 1, &region);
    }

    void operator()(const Fill& fill) const {
        check_part(fill.buffer, fill.offset, fill.bytes, "a fill");
        require(fill.offset % 4 == 0 && fill.bytes % 4 == 0, "a fill that is not of whole words");
        if (fill.bytes == 0) return;
        vkCmdFillBuffer(commands_, fill.buffer->get(), fill.offset, fill.bytes, fill.word);
    }

  private:
    VkCommandBuffer commands_;
    const DeviceInfo& info_;
};

}  // namespace

bool Submission::done() const {
    return queue_ == nullptr || queue_->completed() >= ticket_;
}

void Submission::wait() const {
    if (queue_ != nullptr) queue_->wait_for(ticket_, UINT64_MAX);
}

bool Submission::wait_for(std::chrono::nanoseconds time) const {
    return queue_ == nullptr || queue_->wait_for(ticket_, static_cast<std::uint64_t>(time.count()));
}

Queue::Queue(VkDevice device, const DeviceInfo& info, std::uint32_t family)
    : device_(device), info_(info), family_(family) {
    vkGetDeviceQueue(device, family, 0, &queue_);
    const VkSemaphoreTypeCreateInfo type{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO,
                                         .semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE};
    const VkSemaphoreCreateInfo semaphore{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = &type};
    VkSemaphore object = VK_NULL_HANDLE;
    check(vkCreateSemaphore(device, &semaphore, nullptr, &object), "make a timeline");
    timeline_ = {device, object};
}

Queue::~Queue() {
    vkDeviceWaitIdle(device_);
}

std::shared_ptr<Submission::Slot> Queue::free_slot() {
    const std::uint64_t done = completed();
    for (const std::shared_ptr<Submission::Slot>& slot : slots_) {
        if (slot.use_count() == 1 && slot->ticket <= done) return slot;
    }
    auto slot = std::make_shared<Submission::Slot>();
    const VkCommandPoolCreateInfo pool_info{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                            .queueFamilyIndex = family_};
    VkCommandPool pool = VK_NULL_HANDLE;
    check(vkCreateCommandPool(device_, &pool_info, nullptr, &pool), "make a command pool");
    slot->pool = {device_, pool};
    const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                           .commandPool = pool,
                                           .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                           .commandBufferCount = 1};
    check(vkAllocateCommandBuffers(device_, &info, &slot->commands), "make a command buffer");
    slots_.push_back(slot);
    return slot;
}

void Queue::record(VkCommandBuffer commands, std::span<const Step> steps) const {
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    check(vkBeginCommandBuffer(commands, &begin), "record commands");
    const Recorder recorder(commands, info_);
    for (const Step& step : steps) {
        full_barrier(commands);
        std::visit(recorder, step);
    }
    full_barrier(commands);
    check(vkEndCommandBuffer(commands), "record commands");
}

Submission Queue::submit(std::span<const Step> steps) {
    Submission submission;
    {
        const std::scoped_lock lock(mutex_);
        const std::shared_ptr<Submission::Slot> slot = free_slot();
        check(vkResetCommandPool(device_, slot->pool.get(), 0), "reset a command pool");
        record(slot->commands, steps);
        const VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                                 .commandBuffer = slot->commands};
        const VkSemaphoreSubmitInfo signal{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                           .semaphore = timeline_.get(),
                                           .value = submitted_ + 1,
                                           .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
        const VkSubmitInfo2 info{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                                 .commandBufferInfoCount = 1,
                                 .pCommandBufferInfos = &commands,
                                 .signalSemaphoreInfoCount = 1,
                                 .pSignalSemaphoreInfos = &signal};
        check(vkQueueSubmit2(queue_, 1, &info, VK_NULL_HANDLE), "submit work to the device");
        slot->ticket = ++submitted_;
        submission.queue_ = this;
        submission.slot_ = slot;
        submission.ticket_ = submitted_;
    }
    collect();
    return submission;
}

void Queue::wait_idle() {
    std::uint64_t last = 0;
    {
        const std::scoped_lock lock(mutex_);
        last = submitted_;
    }
    wait_for(last, UINT64_MAX);
    collect();
}

void Queue::retire(std::shared_ptr<void> object) {
    const std::uint64_t done = completed();
    const std::scoped_lock lock(mutex_);
    if (submitted_ > done) retired_.push_back({submitted_, std::move(object)});
}

std::uint64_t Queue::completed() const {
    std::uint64_t value = 0;
    check(vkGetSemaphoreCounterValue(device_, timeline_.get(), &value), "ask how far the device is");
    return value;
}

bool Queue::wait_for(std::uint64_t ticket, std::uint64_t nanoseconds) const {
    const VkSemaphore semaphore = timeline_.get();
    const VkSemaphoreWaitInfo info{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO,
                                   .semaphoreCount = 1,
                                   .pSemaphores = &semaphore,
                                   .pValues = &ticket};
    const VkResult result = vkWaitSemaphores(device_, &info, nanoseconds);
    if (result == VK_TIMEOUT) return false;
    check(result, "wait for the device");
    return true;
}

void Queue::collect() {
    std::vector<Retired> done;  // destroyed after the lock is gone: their memory has a lock of its own
    const std::uint64_t value = completed();
    const std::scoped_lock lock(mutex_);
    const auto kept = std::partition(retired_.begin(), retired_.end(),
                                     [value](const Retired& item) { return item.ticket > value; });
    done.assign(std::make_move_iterator(kept), std::make_move_iterator(retired_.end()));
    retired_.erase(kept, retired_.end());
}

}  // namespace tessera::vulkan
