#include "client/tools/interrupts.h"

#include <signal.h>

#include <cstdlib>

#include "client/tools/command.h"

namespace tessera::tools {

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
            if (!source_.request_stop()) std::_Exit(ExitInterrupted);
        }
    });
}

}  // namespace tessera::tools
