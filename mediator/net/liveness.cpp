#include "mediator/net/liveness.h"

#include <algorithm>

namespace tessera::net {

Liveness::Liveness(const LivenessSettings& settings, TimePoint now)
    : settings_(settings),
      last_heard_(now),
      last_sent_(now - settings.interval),
      backoff_(settings.min_backoff) {}

void Liveness::on_message(TimePoint now) {
    last_heard_ = std::max(last_heard_, now);
    backoff_ = settings_.min_backoff;
}

void Liveness::sent_heartbeat(TimePoint now) {
    last_sent_ = now;
}

bool Liveness::heartbeat_due(TimePoint now) const {
    return now - last_sent_ >= settings_.interval;
}

bool Liveness::timed_out(TimePoint now) const {
    return now >= times_out_at();
}

TimePoint Liveness::times_out_at() const {
    return last_heard_ + settings_.interval * settings_.missed;
}

TimePoint Liveness::next_event() const {
    return std::min(last_sent_ + settings_.interval, times_out_at());
}

Duration Liveness::next_backoff() {
    const Duration now = backoff_;
    backoff_ = std::min(2 * backoff_, settings_.max_backoff);
    return now;
}

void Liveness::was_deaf(Duration time, TimePoint now) {
    last_heard_ = std::max(last_heard_, std::min(now, last_heard_ + time));
    if (time >= settings_.interval * settings_.missed)
        last_heard_ = std::max(last_heard_, now + settings_.max_backoff);
}

void Liveness::restarted(TimePoint now) {
    last_heard_ = now;
}

}  // namespace tessera::net
