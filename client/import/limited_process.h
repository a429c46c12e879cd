#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "mediator/base/error.h"

namespace tessera::import {

struct ProcessLimits {
    std::uint64_t memory =
        0;  // bytes of address space beyond what this process has; not in builds with sanitizers
    std::chrono::seconds processor_time{0};
    std::chrono::seconds wall_time{0};
};

using ByteSink = std::function<void(std::span<const std::byte>)>;  // takes all of them
using ByteSource = std::function<void(std::span<std::byte>)>;      // fills all of it, or throws

// Runs `produce` in a child process, for code that may crash, hang or allocate without end; what it writes is what
// `consume` reads here, at the same time. An Error or std::bad_alloc of `produce` is thrown here; so is an Error that
// says what else ended the child: InvalidInput (a crash, too much time), OutOfMemory, Unavailable (an interrupt, or no
// process can be started). `consume` must treat the bytes as untrusted.
//
// The child is a fork without exec, since this code is linked into programs and Python alike, which have no command to
// run it. Other threads may hold locks at that moment: glibc makes malloc and stdio usable in the child, which needs
// nothing else; `produce` must not log, start threads, or use TBB or ZeroMQ. The child has default signal handlers and
// none of the parent's files, writes no core, and dies with the calling thread, so an interrupt of this process ends
// both.
void run_limited(const ProcessLimits& limits, const std::function<void(const ByteSink&)>& produce,
                 const std::function<void(const ByteSource&)>& consume);

}  // namespace tessera::import
