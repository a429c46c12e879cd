#pragma once

#include <ctime>
#include <string_view>

#include "mediator/base/clock.h"
#include "mediator/session/loop_status.h"

namespace tessera::master {

// How long the event loop is away from its socket, how much of its thread's CPU time that takes, and which part takes
// the most. One thread: the loop's.
class LoopMonitor {
  public:
    // A part of the present step took so much CPU time.
    void ran(std::string_view part, Duration cpu);
    // The step has ended: its time, waiting for messages excluded, and its CPU time.
    void stepped(Duration busy, Duration cpu);
    const session::LoopStatus& status() const { return status_; }

    static Duration thread_cpu_time();

  private:
    session::LoopStatus status_;
    std::string_view longest_part_;  // of the present step
    Duration longest_cpu_{};
};

}  // namespace tessera::master
