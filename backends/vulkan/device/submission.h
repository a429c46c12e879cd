#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

namespace tessera::vulkan {

class Queue;
struct SubmissionSlot;

enum class Timing { None, Total, Steps };

// Submitted steps. Destroying it abandons them: they still run to completion. The queue outlives it.
class Submission final {
  public:
    Submission() = default;  // empty: done

    // All throw DeviceLost.
    bool done() const;
    void wait() const;
    bool wait_for(std::chrono::nanoseconds time) const;  // false: not done yet

    // Waits, then returns device times: one for Timing::Total, one per step for Timing::Steps (steps that overlap
    // have their common time); empty for Timing::None and on a device without timestamps.
    std::vector<double> seconds() const;

  private:
    friend class Queue;
    const Queue* queue_ = nullptr;
    std::shared_ptr<SubmissionSlot> slot_;
    std::uint64_t ticket_ = 0;
};

}  // namespace tessera::vulkan
