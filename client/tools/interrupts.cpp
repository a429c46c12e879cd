#include "client/tools/interrupts.h"

#include <signal.h>

#include <atomic>
#include <cstdlib>

#include "client/tools/command.h"

namespace tessera::tools {

namespace {
std::atomic<bool> any_requested = false;
}

bool Interrupts::requested() {
    return any_requested;
}

Interrupts::Interrupts() {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    thread_ = std::jthread([this, signals](std::stop_token end) {
        constexpr timespec LookAgain{.tv_sec = 0, .tv_nsec = 50'000'000};
        while (!end.stop_requested()) {
            if (sigtimedwait(&signals, nullptr, &LookAgain) < 0) continue;
            any_requested = true;
            if (!source_.request_stop()) std::_Exit(ExitInterrupted);
        }
    });
}

}  // namespace tessera::tools
