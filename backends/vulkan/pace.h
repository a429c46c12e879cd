#pragma once

#include <atomic>
#include <cstdint>

namespace tessera::vulkan {

// How many samples one dispatch may have, so that none runs long: a stop waits for what is running, and
// drivers take a device away from kernels that run for seconds. Learns from what dispatches took.
// Thread-safe.
class Pace final {
  public:
    static constexpr double Target = 0.012;          // seconds of one dispatch; two are on their way at once
    static constexpr std::uint32_t First = 2048;     // samples, before anything is known
    static constexpr std::uint32_t Most = 1u << 19;  // bounds the memory of the results

    std::uint32_t samples() const;
    void learn(std::uint32_t samples, double seconds);

  private:
    std::atomic<double> seconds_per_sample_ = 0.0;  // 0: unknown
};

}  // namespace tessera::vulkan
