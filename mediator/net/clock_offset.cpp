#include "mediator/net/clock_offset.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace tessera::net {

namespace {

// 2^60 ns are 36 years: sums and differences of four such numbers fit.
constexpr std::int64_t Limit = std::int64_t{1} << 60;

bool in_range(std::int64_t value) {
    return value > -Limit && value < Limit;
}

std::int64_t round_trip(const ClockExchange& e) {
    return (e.received - e.sent) - (e.sent_there - e.received_there);
}

std::int64_t drift_since(std::int64_t then, std::int64_t now) {
    return static_cast<std::int64_t>(PeerClock::MaxDrift * static_cast<double>(std::abs(now - then))) + 1;
}

bool contradict(const ClockExchange& a, const ClockExchange& b) {
    const std::int64_t drift = drift_since(a.received, b.received);
    return a.received_there - a.sent + drift < b.sent_there - b.received ||
           b.received_there - b.sent + drift < a.sent_there - a.received;
}

}  // namespace

std::optional<Duration> PeerClock::add(const ClockExchange& e) {
    if (!in_range(e.sent) || !in_range(e.received_there) || !in_range(e.sent_there) || !in_range(e.received))
        return std::nullopt;
    if (e.received < e.sent || e.sent_there < e.received_there || round_trip(e) < 0) return std::nullopt;
    const auto jumped = std::find_if(exchanges_.rbegin(), exchanges_.rend(),
                                     [&](const ClockExchange& older) { return contradict(older, e); });
    exchanges_.erase(exchanges_.begin(), jumped.base());
    exchanges_.push_back(e);
    if (exchanges_.size() > MaxExchanges) exchanges_.pop_front();
    return Duration(round_trip(e));
}

std::optional<Duration> PeerClock::heartbeat(std::int64_t sent_at, std::int64_t echo_sent_at,
                                             std::int64_t echo_delay, TimePoint now) {
    if (echo_sent_at == 0 || !in_range(sent_at) || !in_range(echo_delay)) return std::nullopt;
    return add({.sent = echo_sent_at,
                .received_there = sent_at - echo_delay,
                .sent_there = sent_at,
                .received = now.time_since_epoch().count()});
}

std::optional<ClockOffset> PeerClock::offset(TimePoint now) const {
    if (exchanges_.empty()) return std::nullopt;
    const std::int64_t at = std::clamp(now.time_since_epoch().count(), -Limit, Limit);
    const auto bound = [&](const ClockExchange& e) {
        return (round_trip(e) + 1) / 2 +
               drift_since(e.received, at);  // rounded up, as the midpoint is rounded
    };
    const ClockExchange& best = *std::min_element(
        exchanges_.begin(), exchanges_.end(),
        [&](const ClockExchange& a, const ClockExchange& b) { return bound(a) < bound(b); });
    const std::int64_t twice = (best.received_there - best.sent) + (best.sent_there - best.received);
    return ClockOffset{Duration(twice / 2), Duration(bound(best))};
}

std::int64_t to_our_clock(std::int64_t theirs, const ClockOffset& offset) {
    std::int64_t ours = 0;
    if (!__builtin_sub_overflow(theirs, offset.offset.count(), &ours)) return ours;
    return theirs < 0 ? std::numeric_limits<std::int64_t>::min() : std::numeric_limits<std::int64_t>::max();
}

}  // namespace tessera::net
