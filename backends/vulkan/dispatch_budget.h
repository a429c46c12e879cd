#pragma once

#include <atomic>
#include <cstdint>

namespace tessera::vulkan {

// How many samples one dispatch may trace, so that dispatches stay short: cancellation waits for running
// dispatches, and drivers reset a device whose kernels run for seconds. Adapts to measured times. Thread-safe.
class DispatchBudget final {
  public:
    static constexpr double TargetSeconds = 0.012;         // per dispatch; two are in flight at a time
    static constexpr std::uint32_t InitialSamples = 2048;  // before the first measurement
    static constexpr std::uint32_t MaxSamples = 1u << 19;  // limits the memory for results

    std::uint32_t samples() const;
    void update(std::uint32_t samples, double seconds);

  private:
    std::atomic<double> seconds_per_sample_ = 0.0;  // 0: unknown
};

}  // namespace tessera::vulkan
