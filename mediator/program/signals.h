#pragma once

#include <csignal>
#include <functional>
#include <thread>

namespace tessera::cli {

// What a server does about signals. The first SIGINT or SIGTERM asks it to stop, the second to do so at once; if it is
// still running 80 ms later, the process ends with 128 + the signal's number. SIGHUP reloads, or stops where there is
// nothing to reload. SIGUSR1 and SIGUSR2, which batch systems send, are ignored.
struct SignalHandlers {  // called on the thread of the signals
    std::function<void()> stop, stop_at_once, reload;
};

// Blocks these signals. Call it before any thread starts, so that none is interrupted.
void block_signals();

// Waits for the signals, on a thread of its own.
class SignalThread {
  public:
    explicit SignalThread(SignalHandlers handlers);

  private:
    void take(int signal);

    SignalHandlers handlers_;
    int stops_ = 0;
    std::jthread thread_;
};

}  // namespace tessera::cli
