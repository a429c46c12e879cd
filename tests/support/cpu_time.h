#pragma once

#include <ctime>

namespace tessera::test {

// CPU time of the calling thread in seconds: independent of other programs. A tbb::task_arena with one thread runs in its
// caller.
inline double thread_cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Such a program takes several times as long, so that only ratios of times mean anything.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool IsSanitized = true;
#else
inline constexpr bool IsSanitized = false;
#endif

}  // namespace tessera::test
