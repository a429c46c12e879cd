#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "mediator/base/clock.h"

namespace tessera::net {

// A peer's clock less ours. The truth lies within `bound` of it, on either side.
struct ClockOffset {
    Duration offset{0}, bound{0};  // a bound is never 0
};

// There and back: a message of ours and the peer's answer to it, in ns of the clock of who looked at it.
struct ClockExchange {
    std::int64_t sent = 0;            // ours
    std::int64_t received_there = 0;  // theirs
    std::int64_t sent_there = 0;      // theirs
    std::int64_t received = 0;        // ours
};

// How far a peer's clock is from ours, from the four times of each exchange (Mills, RFC 5905): a message
// takes no negative time, so sent_there - received <= offset <= received_there - sent, an interval as long as
// the round trip, whatever either way took. Of the last 60 exchanges the one with the least bound is stated:
// half of its round trip, and MaxDrift for every second since.
//
// Two exchanges whose intervals do not meet, drift included, contradict each other: a clock has jumped in
// between, and the older one and all before it are dropped. Exchanges that cannot be (a round trip below 0,
// numbers beyond 36 years) are ignored. Pure; one thread.
class PeerClock {
  public:
    static constexpr std::size_t Kept = 60;
    // Two clocks with 50 ppm each way, as crystals are sold, drift apart by at most this.
    static constexpr double MaxDrift = 100e-6;

    // The round trip; nothing for what was ignored.
    std::optional<Duration> add(const ClockExchange& exchange);
    // The same of a heartbeat that came now; one that echoes none of ours (echo_sent_at 0) tells nothing.
    std::optional<Duration> heartbeat(std::int64_t sent_at, std::int64_t echo_sent_at,
                                      std::int64_t echo_delay, TimePoint now);

    std::optional<ClockOffset> offset(TimePoint now) const;  // nothing before the first exchange
    std::size_t size() const { return exchanges_.size(); }   // that count

  private:
    std::deque<ClockExchange> exchanges_;  // oldest first
};

// A time of the peer's clock in ours. Saturates.
std::int64_t to_our_clock(std::int64_t theirs, const ClockOffset& offset);

}  // namespace tessera::net
