#include "master/render/schedule/stuck_allowance.h"

#include <algorithm>

namespace tessera::master {

Duration stuck_allowance(const StuckSettings& settings, double rate, std::uint64_t samples) {
    constexpr double MaxSeconds = 86400.0;
    if (rate <= 0.0) return settings.first_film;
    const double expected = settings.predicted_times * static_cast<double>(samples) / rate;
    return std::chrono::duration_cast<Duration>(
        std::chrono::duration<double>(std::min(MaxSeconds, expected)));
}

}  // namespace tessera::master
