#pragma once

#include <chrono>

namespace tessera::test {

// From the first call on, the steady clock of this process stands still while any of its threads runs or waits for the
// disk. When all of them sleep, it jumps to the earliest end of a timed wait. So a timeout ends at once if nothing else
// can happen, and never because the machine is slow. Virtual are std::chrono::steady_clock, waits for condition variables
// until a time of it, and std::this_thread::sleep_for(); futures wait by the real clock, sockets are not supported. Ends
// with the process. Linux.
void begin_virtual_time();

// Since it has begun; 0 before.
std::chrono::nanoseconds virtual_time();

}  // namespace tessera::test
