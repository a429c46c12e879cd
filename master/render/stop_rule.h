#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "mediator/base/clock.h"

namespace tessera::master {

inline constexpr std::uint64_t MaxSamplesPerPixel = std::uint64_t{1} << 31;  // counts are 32 bits

// When a view has enough samples. Pure.
struct StopRule {
    std::uint64_t spp = 64;  // 0: as many as fit into the time
    Duration time_limit{0};  // of sampling; 0 = none
    Duration budget{0};  // not 0: the picture is there so long after the start, filter and encoding included
    bool adapts_size =
        false;  // with a budget too small for 2 samples per pixel: half or a quarter of the size

    bool has_budget() const { return budget > Duration::zero(); }
    bool has_clock() const { return has_budget() || time_limit > Duration::zero(); }
    // The samples of a pixel that are never exceeded.
    std::uint64_t most_samples() const {
        return has_budget() || (has_clock() && spp == 0) ? MaxSamplesPerPixel : spp;
    }

    // When sampling must end, given when nodes were ready and how long filter and encoding will take.
    std::optional<TimePoint> deadline(TimePoint ready, TimePoint now, Duration afterwards) const {
        if (has_budget()) return std::max(now, ready + budget - afterwards);
        if (has_clock()) return now + time_limit;
        return std::nullopt;
    }

    // Against a budget every pixel shall have its first samples; for that it may be late by a part of it.
    bool time_is_up(std::optional<TimePoint> deadline, bool every_pixel_has_samples, TimePoint now) const {
        if (!deadline || now < *deadline) return false;
        if (!has_budget() || every_pixel_has_samples) return true;
        constexpr int PartOfBudget = 8;
        return now >= *deadline + budget / PartOfBudget;
    }

    friend bool operator==(const StopRule&, const StopRule&) = default;
};

}  // namespace tessera::master
