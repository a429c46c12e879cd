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

}  // namespace tessera::test
