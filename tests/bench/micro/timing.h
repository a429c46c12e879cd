#pragma once

#include <algorithm>
#include <ctime>
#include <vector>

namespace tessera::bench {

// Processor time of this thread, independent of other load.
inline double cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

inline double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

}  // namespace tessera::bench
