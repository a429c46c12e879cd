#pragma once

#include <vulkan/vulkan_core.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "backends/vulkan/device/barrier_plan.h"
#include "backends/vulkan/device/device_list.h"
#include "backends/vulkan/device/fault.h"
#include "backends/vulkan/device/handle.h"
#include "backends/vulkan/device/step.h"
#include "backends/vulkan/device/submission.h"

namespace tessera::vulkan {

// Runs steps on the device, ordered by submission as far as their reads and writes require. Thread-safe. After a
// call reported VK_ERROR_DEVICE_LOST, all later ones throw DeviceLost.
class Queue final {
  public:
    Queue(VkDevice device, const DeviceInfo& info, std::uint32_t family, FaultHook fault);
    ~Queue();  // waits for all submissions
    Queue(const Queue&) = delete;
    Queue& operator=(const Queue&) = delete;

    // Does not block. The steps see all previous writes of the host. Throws DeviceLost, or Error{Internal} for an
    // invalid step (see check_step); then none of them runs.
    Submission submit(std::span<const Step> steps, Timing timing = Timing::None);
    Submission submit(const Step& step, Timing timing = Timing::None) {
        return submit(std::span(&step, 1), timing);
    }
    Submission latest() const;  // done when everything submitted so far is done; without times

    // Keeps `object` alive until everything submitted so far is done.
    void retire(std::shared_ptr<void> object) noexcept;
    void collect() noexcept;  // destroys retired objects that are no longer in use

  private:
    friend class Submission;
    struct Retired {
        std::uint64_t ticket;
        std::shared_ptr<void> object;
    };

    void check_call(VkResult result, const char* operation) const;
    VkResult fault(FaultPoint point) const;
    std::shared_ptr<SubmissionSlot> free_slot();
    void record(SubmissionSlot& slot, std::span<const Step> steps, Timing timing);
    void send(const SubmissionSlot& slot);
    std::uint64_t completed() const;
    std::uint64_t completed_or_lost() const noexcept;
    bool wait_for(std::uint64_t ticket, std::uint64_t nanoseconds) const;
    std::vector<double> seconds_of(const SubmissionSlot& slot) const;

    VkDevice device_;
    const DeviceInfo& info_;
    std::uint32_t family_;
    FaultHook fault_;
    std::uint32_t timestamp_bits_ = 0;
    VkQueue queue_ = VK_NULL_HANDLE;
    Handle<VkSemaphore, vkDestroySemaphore> timeline_;
    mutable std::atomic<bool> is_lost_ = false;

    mutable std::mutex mutex_;  // protects everything below
    std::uint64_t submitted_ = 0;
    bool is_plan_valid_ = false;
    BarrierPlan plan_;
    std::vector<std::shared_ptr<SubmissionSlot>> slots_;
    std::vector<Retired> retired_;
};

}  // namespace tessera::vulkan
