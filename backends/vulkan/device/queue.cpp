#include "backends/vulkan/device/queue.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "backends/vulkan/device/bindings.h"
#include "backends/vulkan/device/recorder.h"
#include "backends/vulkan/device/result.h"
#include "backends/vulkan/device/submission_slot.h"

namespace tessera::vulkan {

namespace {

// A plan with more buffers than this is reset behind a full barrier, so that it does not grow without bound.
constexpr std::size_t MaxPlanned = 4096;

}  // namespace

bool Submission::done() const {
    return queue_ == nullptr || queue_->completed() >= ticket_;
}

void Submission::wait() const {
    if (queue_ != nullptr) queue_->wait_for(ticket_, UINT64_MAX);
}

bool Submission::wait_for(std::chrono::nanoseconds time) const {
    if (queue_ == nullptr) return true;
    return queue_->wait_for(ticket_, static_cast<std::uint64_t>(std::max<std::int64_t>(0, time.count())));
}

std::vector<double> Submission::seconds() const {
    if (slot_ == nullptr) return {};
    wait();
    return queue_->seconds_of(*slot_);
}

Queue::Queue(VkDevice device, const DeviceInfo& info, std::uint32_t family, FaultHook fault)
    : device_(device), info_(info), family_(family), fault_(std::move(fault)) {
    vkGetDeviceQueue(device, family, 0, &queue_);
    std::uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(info.handle, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(info.handle, &count, families.data());
    if (info.timestamp_period > 0) timestamp_bits_ = families[family].timestampValidBits;

    const VkSemaphoreTypeCreateInfo type{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO,
                                         .semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE};
    const VkSemaphoreCreateInfo semaphore{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = &type};
    VkSemaphore object = VK_NULL_HANDLE;
    check(vkCreateSemaphore(device, &semaphore, nullptr, &object), "create a timeline semaphore");
    timeline_ = {device, object};
}

Queue::~Queue() {
    vkDeviceWaitIdle(device_);
}

void Queue::check_call(VkResult result, const char* operation) const {
    if (result == VK_ERROR_DEVICE_LOST) is_lost_ = true;
    check(result, operation);
}

VkResult Queue::fault(FaultPoint point) const {
    if (is_lost_) return VK_ERROR_DEVICE_LOST;
    return fault_ ? fault_(point) : VK_SUCCESS;
}

std::shared_ptr<SubmissionSlot> Queue::free_slot() {
    const std::uint64_t done = completed();
    for (const std::shared_ptr<SubmissionSlot>& slot : slots_) {
        if (slot.use_count() == 1 && slot->ticket <= done) return slot;
    }
    return slots_.emplace_back(std::make_shared<SubmissionSlot>(device_, family_));
}

void Queue::record(SubmissionSlot& slot, std::span<const Step> steps, Timing timing) {
    slot.reset();
    if (timestamp_bits_ > 0 && !steps.empty() && timing != Timing::None) {
        slot.reserve_timestamps(timing == Timing::Total ? 2 : static_cast<std::uint32_t>(steps.size() + 1));
    }
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    check(vkBeginCommandBuffer(slot.commands, &begin), "record commands");
    const BindingCount count = count_bindings(steps);
    slot.reserve_descriptor_sets(count.sets, count.storage, count.texels);
    Recorder recorder(device_, slot, plan_);
    if (!is_plan_valid_ || plan_.size() > MaxPlanned) recorder.full_barrier();
    is_plan_valid_ = false;  // until the planned commands are submitted
    if (slot.stamps > 0) recorder.timestamp();
    for (std::size_t i = 0; i < steps.size(); ++i) {
        recorder.record(steps[i]);
        const bool is_stamped = slot.stamps > 2 || i + 1 == steps.size();
        if (slot.stamps > 0 && is_stamped) recorder.timestamp();
    }
    recorder.make_visible_to_host();
    check(vkEndCommandBuffer(slot.commands), "record commands");
}

void Queue::send(const SubmissionSlot& slot) {
    // Not vkQueueSubmit2: after it GPU-assisted validation (1.3.239) waits 10 s for the timeline and reports
    // a bug of its own.
    const VkSemaphore timeline = timeline_.get();
    const VkTimelineSemaphoreSubmitInfo value{.sType = VK_STRUCTURE_TYPE_TIMELINE_SEMAPHORE_SUBMIT_INFO,
                                              .signalSemaphoreValueCount = 1,
                                              .pSignalSemaphoreValues = &slot.ticket};
    const VkSubmitInfo info{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                            .pNext = &value,
                            .commandBufferCount = 1,
                            .pCommandBuffers = &slot.commands,
                            .signalSemaphoreCount = 1,
                            .pSignalSemaphores = &timeline};
    const VkResult injected = fault(FaultPoint::Submit);
    check_call(injected != VK_SUCCESS ? injected : vkQueueSubmit(queue_, 1, &info, VK_NULL_HANDLE),
               "submit work to the device");
}

Submission Queue::submit(std::span<const Step> steps, Timing timing) {
    for (const Step& step : steps) check_step(step, info_);
    Submission submission;
    {
        const std::scoped_lock lock(mutex_);
        const std::shared_ptr<SubmissionSlot> slot = free_slot();
        record(*slot, steps, timing);
        slot->ticket = submitted_ + 1;
        send(*slot);
        submitted_ = slot->ticket;
        is_plan_valid_ = true;
        submission.queue_ = this;
        submission.slot_ = slot;
        submission.ticket_ = submitted_;
    }
    collect();
    return submission;
}

Submission Queue::latest() const {
    Submission submission;
    const std::scoped_lock lock(mutex_);
    submission.queue_ = this;
    submission.ticket_ = submitted_;
    return submission;
}

void Queue::retire(std::shared_ptr<void> object) noexcept {
    const std::uint64_t done = completed_or_lost();
    const std::scoped_lock lock(mutex_);
    if (submitted_ > done) retired_.push_back({submitted_, std::move(object)});
}

std::uint64_t Queue::completed() const {
    std::uint64_t value = 0;
    check_call(is_lost_ ? VK_ERROR_DEVICE_LOST : vkGetSemaphoreCounterValue(device_, timeline_.get(), &value),
               "query the progress of the device");
    return value;
}

// A lost device never signals completion: its objects may be destroyed at once.
std::uint64_t Queue::completed_or_lost() const noexcept {
    std::uint64_t value = 0;
    const VkResult result = vkGetSemaphoreCounterValue(device_, timeline_.get(), &value);
    return result == VK_SUCCESS ? value : UINT64_MAX;
}

bool Queue::wait_for(std::uint64_t ticket, std::uint64_t nanoseconds) const {
    const VkSemaphore semaphore = timeline_.get();
    const VkSemaphoreWaitInfo info{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO,
                                   .semaphoreCount = 1,
                                   .pSemaphores = &semaphore,
                                   .pValues = &ticket};
    const VkResult injected = fault(FaultPoint::Wait);
    const VkResult result = injected != VK_SUCCESS ? injected : vkWaitSemaphores(device_, &info, nanoseconds);
    if (result == VK_TIMEOUT) return false;
    check_call(result, "wait for the device");
    return true;
}

std::vector<double> Queue::seconds_of(const SubmissionSlot& slot) const {
    const std::vector<std::uint64_t> ticks = slot.read();
    const std::uint64_t valid = timestamp_bits_ < 64 ? (std::uint64_t(1) << timestamp_bits_) - 1 : ~0ull;
    std::vector<double> seconds;
    for (std::size_t i = 0; i + 1 < ticks.size(); ++i) {
        const std::uint64_t passed = (ticks[i + 1] - ticks[i]) & valid;
        seconds.push_back(double(passed) * double(info_.timestamp_period) * 1e-9);
    }
    return seconds;
}

void Queue::collect() noexcept {
    const std::uint64_t done = completed_or_lost();
    std::vector<Retired> ended;  // destroyed after the lock is released: their memory has its own lock
    const std::scoped_lock lock(mutex_);
    const auto first = std::partition(retired_.begin(), retired_.end(),
                                      [done](const Retired& item) { return item.ticket > done; });
    ended.assign(std::make_move_iterator(first), std::make_move_iterator(retired_.end()));
    retired_.erase(first, retired_.end());
}

}  // namespace tessera::vulkan
