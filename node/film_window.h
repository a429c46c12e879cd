#pragma once

#include <cstdint>
#include <deque>

#include "mediator/base/clock.h"

namespace tessera::node {

// How many bytes of film may be on their way to the master. Film that waits in queues of the network is outdated when it
// arrives, so the window follows the time from sending to merging: it shrinks when that exceeds the target (as LEDBAT does,
// RFC 6817), and grows while the window is the limit. Pure.
class FilmWindow {
  public:
    static constexpr Duration Target = std::chrono::milliseconds(50);
    static constexpr std::uint64_t Smallest = std::uint64_t{64} << 10;  // less than a message: one at a time
    static constexpr std::uint64_t Largest = std::uint64_t{64} << 20;

    bool has_room() const { return sent_ - taken_ < size_; }
    void sent(std::uint64_t bytes, TimePoint now);
    // The master has taken so many bytes in all.
    void taken(std::uint64_t bytes, TimePoint now);
    void restart();  // another link, on which nothing was sent

    std::uint64_t size() const { return size_; }
    std::uint64_t in_flight() const { return sent_ - taken_; }

  private:
    struct Message {
        std::uint64_t end = 0;  // bytes sent in all, with it
        TimePoint sent_at{};
        bool filled_window = false;
    };
    std::uint64_t size_ = std::uint64_t{4} << 20, sent_ = 0, taken_ = 0;
    std::uint64_t shrink_again_at_ = 0;  // bytes taken: once per window
    std::deque<Message> messages_;
};

}  // namespace tessera::node
