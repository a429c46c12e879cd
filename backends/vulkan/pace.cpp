#include "backends/vulkan/pace.h"

#include <algorithm>

namespace tessera::vulkan {

std::uint32_t Pace::samples() const {
    const double each = seconds_per_sample_;
    if (!(each > 0.0)) return First;
    return static_cast<std::uint32_t>(std::clamp(Target / each, 64.0, double(Most)));
}

void Pace::learn(std::uint32_t samples, double seconds) {
    if (samples == 0 || !(seconds > 0.0)) return;
    const double now = seconds / samples, before = seconds_per_sample_;
    // Slower at once, faster by and by: other pixels may see more.
    seconds_per_sample_ = before > 0.0 && now < before ? 0.75 * before + 0.25 * now : now;
}

}  // namespace tessera::vulkan
