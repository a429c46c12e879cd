#pragma once

#include <chrono>
#include <exception>
#include <map>
#include <string>
#include <string_view>

#include "master/loop/loop_monitor.h"
#include "master/peers/event.h"
#include "mediator/base/clock.h"

namespace tessera::master {

// Nothing ends the event loop: an exception in one of its parts is logged and counted, and the loop goes on. Repeated
// ones are logged once a second. One thread.
class Guard {
  public:
    Guard(const Clock& clock, EventSink events, LoopMonitor& monitor)
        : clock_(clock), events_(std::move(events)), monitor_(monitor) {}

    // `what`: the part, for the log. Returns whether it ended without an exception. Its CPU time is measured.
    template <class Part>
    bool run(std::string_view what, const Part& part) {
        const Duration before = LoopMonitor::thread_cpu_time();
        const bool good = attempt(what, part);
        monitor_.ran(what, LoopMonitor::thread_cpu_time() - before);
        return good;
    }
    // The same, not measured.
    template <class Part>
    bool attempt(std::string_view what, const Part& part) {
        try {
            part();
            return true;
        } catch (const std::exception& error) {
            caught(what, error.what());
        } catch (...) {
            caught(what, "an unknown exception");
        }
        return false;
    }
    std::uint64_t caught() const { return caught_; }

  private:
    struct Recent {
        TimePoint logged{};
        std::uint64_t silent = 0;  // since then
    };
    void caught(std::string_view what, const char* problem);

    const Clock& clock_;
    EventSink events_;
    LoopMonitor& monitor_;
    std::map<std::string, Recent, std::less<>> recent_;  // by part
    std::uint64_t caught_ = 0;
};

}  // namespace tessera::master
