#pragma once

#include <chrono>
#include <cstdint>

namespace tessera {

using Duration = std::chrono::nanoseconds;
using TimePoint = std::chrono::time_point<std::chrono::steady_clock, Duration>;

// Injected wherever behaviour depends on time, so that tests can control it. Thread-safe.
class Clock {
  public:
    virtual ~Clock() = default;
    virtual TimePoint now() const = 0;
};

class SteadyClock final : public Clock {
  public:
    TimePoint now() const override { return std::chrono::steady_clock::now(); }
};

inline double seconds(Duration duration) {
    return std::chrono::duration<double>(duration).count();
}

// Wall-clock time: ns since 1970.
inline std::int64_t since_1970() {
    return std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace tessera
