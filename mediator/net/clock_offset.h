#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "mediator/base/clock.h"

namespace tessera::net {

// A peer's clock minus ours. The true value is within +-`bound` of it.
struct ClockOffset {
    Duration offset{0}, bound{0};  // a bound is never 0
};

// A message and the peer's answer to it; each time in ns of the clock it was taken from.
struct ClockExchange {
    std::int64_t sent = 0;            // ours
    std::int64_t received_there = 0;  // theirs
    std::int64_t sent_there = 0;      // theirs
    std::int64_t received = 0;        // ours
};

// How far a peer's clock is from ours, from the four times of each exchange (Mills, RFC 5905): a message
// takes no negative time, so sent_there - received <= offset <= received_there - sent, an interval as long as
// the round trip, however it is divided between the directions. The exchange with the smallest bound of the last 60 is
// used: half of its round trip, plus MaxDrift for every second since.
//
// If the intervals of two exchanges do not overlap, drift included, a clock has jumped in between, and the older one and
// all before it are dropped. Impossible exchanges (a negative round trip, times beyond 36 years) are ignored. Pure;
// single-threaded.
class PeerClock {
  public:
    static constexpr std::size_t MaxExchanges = 60;
    // Maximum drift between two clocks of +-50 ppm, the tolerance of common crystals.
    static constexpr double MaxDrift = 100e-6;

    // Returns the round trip; nothing if the exchange was ignored.
    std::optional<Duration> add(const ClockExchange& exchange);
    // The same for a heartbeat that arrived now; one that echoes none of ours (echo_sent_at 0) is ignored.
    std::optional<Duration> heartbeat(std::int64_t sent_at, std::int64_t echo_sent_at,
                                      std::int64_t echo_delay, TimePoint now);

    std::optional<ClockOffset> offset(TimePoint now) const;  // nothing before the first exchange
    std::size_t size() const { return exchanges_.size(); }   // stored exchanges

  private:
    std::deque<ClockExchange> exchanges_;  // oldest first
};

// Converts a time of the peer's clock to ours. Saturates.
std::int64_t to_our_clock(std::int64_t theirs, const ClockOffset& offset);

}  // namespace tessera::net
