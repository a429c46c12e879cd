#pragma once

#include <ctime>
#include <string_view>

#include "mediator/base/clock.h"
#include "mediator/session/loop_status.h"

namespace tessera::master {

// How long the event loop is away from its socket, and which of its parts takes how much of its thread's CPU time. One
// thread: the loop's.
class LoopMonitor {
  public:
    // A step has ended that took this long, waiting for messages excluded.
    void stepped(Duration busy);
    void ran(std::string_view part, Duration cpu);
    const session::LoopStatus& status() const { return status_; }

    static Duration thread_cpu_time();

  private:
    session::LoopStatus status_;
};

}  // namespace tessera::master
