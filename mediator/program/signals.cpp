#include "mediator/program/signals.h"

#include <signal.h>
#include <time.h>

#include <cstdlib>

namespace tessera::cli {

namespace {

constexpr timespec LookAgain{.tv_sec = 0, .tv_nsec = 20'000'000};
constexpr timespec LastGrace{.tv_sec = 0, .tv_nsec = 80'000'000};

sigset_t waited_for() {
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2}) sigaddset(&signals, signal);
    return signals;
}

}  // namespace

void block_signals() {
    const sigset_t signals = waited_for();
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

SignalThread::SignalThread(SignalHandlers handlers)
    : handlers_(std::move(handlers)), thread_([this](const std::stop_token& end) {
          const sigset_t signals = waited_for();
          while (!end.stop_requested()) {
              const int signal = sigtimedwait(&signals, nullptr, &LookAgain);
              if (signal > 0) take(signal);
          }
      }) {}

void SignalThread::take(int signal) {
    if (signal == SIGUSR1 || signal == SIGUSR2) return;
    if (signal == SIGHUP && handlers_.reload) return handlers_.reload();
    if (++stops_ == 1) return handlers_.stop();
    if (handlers_.stop_at_once) {
        handlers_.stop_at_once();
        ::nanosleep(&LastGrace, nullptr);
    }
    std::_Exit(128 + signal);
}

}  // namespace tessera::cli
