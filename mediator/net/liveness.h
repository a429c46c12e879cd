#pragma once

#include "mediator/base/clock.h"

namespace tessera::net {

struct LivenessSettings {
    Duration interval = std::chrono::seconds(1);
    int missed = 3;  // silent for interval x missed = timed out
    Duration min_backoff = std::chrono::milliseconds(100), max_backoff = std::chrono::seconds(5);
};

// Timeout and heartbeat state of a peer. Pure: driven by events and times. Any message counts as a sign of life.
class Liveness {
  public:
    Liveness(const LivenessSettings& settings, TimePoint now);

    void on_message(TimePoint now);  // any message from the peer
    void sent_heartbeat(TimePoint now);
    bool heartbeat_due(TimePoint now) const;
    bool timed_out(TimePoint now) const;
    TimePoint times_out_at() const;
    TimePoint next_event() const;  // when a heartbeat is due or the peer has timed out, whichever comes first

    // After a timeout: doubles from min_backoff to max_backoff until on_message() resets it.
    Duration next_backoff();
    // This process did not listen for that long: the peer's silence counts less. If peers have given it up meanwhile,
    // they are still in their back-off, and are given the time to come back.
    void was_deaf(Duration time, TimePoint now);
    void restarted(TimePoint now);  // sockets are new; silence counts from here

  private:
    LivenessSettings settings_;
    TimePoint last_heard_, last_sent_;
    Duration backoff_;
};

}  // namespace tessera::net
