#pragma once

#include <vulkan/vulkan_core.h>

#include <span>
#include <vector>

#include "backends/vulkan/device/barrier_plan.h"
#include "backends/vulkan/device/device_list.h"
#include "backends/vulkan/device/step.h"
#include "backends/vulkan/device/submission_slot.h"

namespace tessera::vulkan {

// Throws Error{Internal} for an invalid step: a dispatch without a pipeline, arguments of the wrong size, more
// groups than the device allows, a range beyond the end of a buffer.
void check_step(const Step& step, const DeviceInfo& info);

std::vector<Access> accesses_of(const Step& step);

// Records checked steps into a command buffer, with the barriers derived by `plan`.
class Recorder final {
  public:
    // The slot is ready for recording and has sufficient capacity for the steps.
    Recorder(VkDevice device, SubmissionSlot& slot, BarrierPlan& plan)
        : device_(device), slot_(slot), commands_(slot.commands), plan_(plan) {}

    void record(const Step& step);
    void full_barrier();  // inserts a full memory barrier
    void timestamp();     // writes the next timestamp, after everything before is done
    // Before the end: makes writes to host-visible memory available to the host after waiting.
    void make_visible_to_host();

  private:
    void barrier(const Barrier& barrier);
    void record_dispatch(const Dispatch& dispatch);

    VkDevice device_;
    SubmissionSlot& slot_;
    VkCommandBuffer commands_;
    BarrierPlan& plan_;
    std::uint32_t stamp_ = 0;
    std::vector<Access> host_writes_;
};

}  // namespace tessera::vulkan
