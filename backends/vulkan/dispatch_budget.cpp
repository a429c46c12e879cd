#include "backends/vulkan/dispatch_budget.h"

#include <algorithm>

namespace tessera::vulkan {

std::uint32_t DispatchBudget::samples() const {
    const double each = seconds_per_sample_;
    if (!(each > 0.0)) return InitialSamples;
    return static_cast<std::uint32_t>(std::clamp(TargetSeconds / each, 64.0, double(MaxSamples)));
}

void DispatchBudget::update(std::uint32_t samples, double seconds) {
    if (samples == 0 || !(seconds > 0.0)) return;
    const double now = seconds / samples, before = seconds_per_sample_;
    // Reacts at once to slower dispatches and gradually to faster ones: other pixels may be more expensive.
    seconds_per_sample_ = before > 0.0 && now < before ? 0.75 * before + 0.25 * now : now;
}

}  // namespace tessera::vulkan
