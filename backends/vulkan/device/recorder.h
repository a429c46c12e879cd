#pragma once

#include <vulkan/vulkan_core.h>

#include <span>
#include <vector>

#include "backends/vulkan/device/barrier_plan.h"
#include "backends/vulkan/device/device_list.h"
#include "backends/vulkan/device/step.h"
#include "backends/vulkan/device/submission_slot.h"

namespace tessera::vulkan {

// Throws Error{Internal} for a step that is none: a pass without a pipeline, arguments of another size, more
// groups than the device allows, a part beyond a buffer's end.
void check_step(const Step& step, const DeviceInfo& info);

std::vector<Access> accesses_of(const Step& step);

// Writes steps that were checked into a command buffer, with the barriers that `plan` derives.
class Recorder final {
  public:
    // The slot is ready to record into and has room for the steps.
    Recorder(VkDevice device, SubmissionSlot& slot, BarrierPlan& plan)
        : device_(device), slot_(slot), commands_(slot.commands), plan_(plan) {}

    void record(const Step& step);
    void publish();    // a barrier of everything
    void timestamp();  // the next of the slot's, once all before is done
    // Before the end: what the recorded steps wrote into memory that the host sees, it can read after
    // waiting.
    void show_host();

  private:
    void barrier(const Barrier& barrier);
    void dispatch(const Pass& pass);

    VkDevice device_;
    SubmissionSlot& slot_;
    VkCommandBuffer commands_;
    BarrierPlan& plan_;
    std::uint32_t stamp_ = 0;
    std::vector<Access> for_host_;
};

}  // namespace tessera::vulkan
