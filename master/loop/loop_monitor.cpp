#include "master/loop/loop_monitor.h"

#include <algorithm>

namespace tessera::master {

void LoopMonitor::ran(std::string_view part, Duration cpu) {
    if (cpu <= longest_cpu_) return;
    longest_cpu_ = cpu;
    longest_part_ = part;
}

void LoopMonitor::stepped(Duration busy, Duration cpu) {
    const double value = seconds(busy);
    const auto bucket = std::ranges::lower_bound(session::LoopStatus::Bounds, value);
    ++status_.steps[static_cast<std::size_t>(bucket - session::LoopStatus::Bounds.begin())];
    status_.longest_step_seconds = std::max(status_.longest_step_seconds, value);
    if (seconds(cpu) > status_.longest_cpu_seconds) {
        status_.longest_cpu_seconds = seconds(cpu);
        status_.longest_part = longest_part_;
    }
    longest_part_ = {};
    longest_cpu_ = {};
}

Duration LoopMonitor::thread_cpu_time() {
    timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

}  // namespace tessera::master
