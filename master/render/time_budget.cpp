#include "master/render/time_budget.h"

#include <algorithm>

namespace tessera::master {

void TimeBudget::measured(const CostKey& cost_key, std::uint64_t pixels, double seconds) {
    if (pixels == 0 || !(seconds >= 0.0)) return;
    if (seconds_per_pixel_.size() >= MaxCostKeys && !seconds_per_pixel_.contains(cost_key)) {
        seconds_per_pixel_.erase(seconds_per_pixel_.begin());
    }
    std::deque<double>& latest = seconds_per_pixel_[cost_key];
    latest.push_back(seconds / static_cast<double>(pixels));
    if (latest.size() > Remembered) latest.pop_front();
}

std::optional<double> TimeBudget::predict(const CostKey& cost_key, std::uint64_t pixels) const {
    const auto found = seconds_per_pixel_.find(cost_key);
    if (found == seconds_per_pixel_.end()) return std::nullopt;
    return *std::ranges::max_element(found->second) * static_cast<double>(pixels);
}

std::uint32_t scale_that_fits(std::uint64_t pixels, double seconds, double samples_per_second, double least) {
    if (samples_per_second <= 0.0) return 1;
    for (const std::uint32_t scale : {1u, 2u}) {
        const double samples = least * static_cast<double>(pixels) / (scale * scale);
        if (samples <= samples_per_second * seconds) return scale;
    }
    return 4;
}

}  // namespace tessera::master
