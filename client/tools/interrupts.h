#pragma once

#include <stop_token>
#include <thread>

namespace tessera::tools {

// Ctrl-C (or SIGTERM) as a stop token: the first asks to stop, the second ends the program at once with 130.
// Create it before any other thread, so that the signals are blocked in all of them.
class Interrupts {
  public:
    Interrupts();
    static bool requested();  // in this process
    std::stop_token token() const { return source_.get_token(); }

  private:
    std::stop_source source_;
    std::jthread thread_;
};

}  // namespace tessera::tools
