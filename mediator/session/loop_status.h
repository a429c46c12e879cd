#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

namespace tessera::session {

// How busy the master's event loop is.
struct LoopStatus {
    // Upper bounds of the histogram's buckets, in seconds; one more bucket counts what took longer.
    static constexpr std::array<double, 10> Bounds{1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 1e-1, 1.0};
    std::vector<std::uint64_t> steps = std::vector<std::uint64_t>(Bounds.size() + 1);  // by wall time
    double longest_step_seconds = 0.0;
    double longest_cpu_seconds = 0.0;  // of the thread, in one step
    std::string longest_part;          // of that step
    static constexpr auto describe(auto row) {
        using Self = LoopStatus;
        return std::tuple(row(1, "steps", &Self::steps),
                          row(2, "longest_step_seconds", &Self::longest_step_seconds),
                          row(3, "longest_cpu_seconds", &Self::longest_cpu_seconds),
                          row(4, "longest_part", &Self::longest_part));
    }
};

}  // namespace tessera::session
