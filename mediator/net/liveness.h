#pragma once

#include "mediator/base/clock.h"

namespace tessera::net {

struct LivenessSettings {
    Duration interval = std::chrono::seconds(1);
    int missed = 3;  // silent for interval x missed = dead
    Duration min_backoff = std::chrono::milliseconds(100), max_backoff = std::chrono::seconds(5);
};

// Is the other side there? Pure: told what happened and when, says what is due. Any traffic counts as life.
class Liveness {
  public:
    Liveness(const LivenessSettings& settings, TimePoint now);

    void heard(TimePoint now);  // any message from the peer
    void sent_heartbeat(TimePoint now);
    bool heartbeat_due(TimePoint now) const;
    bool dead(TimePoint now) const;
    TimePoint next_event() const;  // when a heartbeat is due or the peer is dead, whichever comes first

    // After death: doubles from min_backoff to max_backoff until heard() resets it.
    Duration next_backoff();
    void restarted(TimePoint now);  // sockets are new; silence counts from here

  private:
    LivenessSettings settings_;
    TimePoint last_heard_, last_sent_;
    Duration backoff_;
};

}  // namespace tessera::net
