#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "mediator/base/clock.h"
#include "mediator/session/status.h"
#include "mediator/wire/display_messages.h"

namespace tessera::master {

struct LockSettings {
    // An output is late when no output became ready for this long, and for twice the longest pause between two in earlier
    // frames (large pictures and busy machines take longer).
    Duration timeout = std::chrono::milliseconds(100);
    Duration first_timeout = std::chrono::seconds(5);  // for the first frame
    // Upper limit of the timeout with an output that was late before.
    Duration max_timeout = std::chrono::seconds(2);
    // Limits of the time between the present message and its present time: the message must have arrived by then.
    Duration min_lead = std::chrono::milliseconds(2), max_lead = std::chrono::milliseconds(50);
};

// A software swap barrier: all outputs of a display present frame f together, in two phases. Every output reports that f
// is ready, then all are sent the present time. An output that is not ready in time is dropped from the lock: it delays
// the others once, by the timeout, and rejoins as soon as it answers. Pure: (state, event, now) -> actions.
//
//   Absent   has no output client             joined -> Joining
//   Joining  takes part from the next frame   begin -> Locked, if it is free
//   Locked   is waited for                    timeout over -> Late · left -> Absent
//   Late     has an old frame in flight       ready, whichever frame -> Joining
class FrameLock {
  public:
    struct Output {
        session::OutputState state = session::OutputState::Absent;
        std::uint64_t in_flight = 0;  // frame that was sent and not answered; 0 = free
        TimePoint sent_at{};          // when
        Duration bound{0};            // of its clock offset
        std::uint64_t frames = 0, late = 0;
    };
    // The message to send: the recipients, the frame and its present time.
    struct Present {
        std::uint64_t frame = 0;
        TimePoint at{};
        std::vector<std::size_t> outputs;
    };

    FrameLock(const LockSettings& settings, std::size_t outputs, Duration interval)
        : settings_(settings), interval_(interval), outputs_(outputs) {}

    void joined(std::size_t output);
    std::optional<Present> left(std::size_t output, TimePoint now);
    void clock_bound(std::size_t output, Duration bound) { outputs_[output].bound = bound; }

    // No frame is in flight.
    bool free() const { return frame_ == 0; }
    // A frame is sent to these outputs now. The lock is free. Who has just joined may be sent the frame that
    // the others show already.
    enum class Recipients { All, Joining };
    std::vector<std::size_t> begin(std::uint64_t frame, Recipients recipients, TimePoint now);
    bool has_joining() const;
    // Frame numbers increase; a report of an older one only shows that the output is alive.
    std::optional<Present> ready(std::size_t output, std::uint64_t frame, TimePoint now);
    // Drops late outputs.
    std::optional<Present> tick(TimePoint now);
    TimePoint next_event() const { return frame_ == 0 ? TimePoint::max() : last_sign_ + timeout(); }

    const std::vector<Output>& outputs() const { return outputs_; }
    std::uint64_t frames() const { return frames_; }  // presented
    double rate(TimePoint now) const;                 // a second, of late; 0 = unknown

  private:
    std::optional<Present> present_if_all_ready(TimePoint now);
    Duration timeout() const {
        return expected_ ? std::max(settings_.timeout, 2 * *expected_) : settings_.first_timeout;
    }

    LockSettings settings_;
    Duration interval_;
    std::vector<Output> outputs_;
    std::uint64_t frame_ = 0;           // in flight; 0 = none
    bool is_new_ = false;               // not presented yet
    TimePoint last_sign_{};             // of the frame: sent, or an output became ready
    Duration pause_{0};                 // the longest between two signs
    std::optional<Duration> expected_;  // from earlier frames, decaying
    std::set<std::size_t> waiting_, ready_;
    TimePoint last_at_{};
    std::vector<TimePoint> presented_;  // the latest
    std::uint64_t frames_ = 0;
};

}  // namespace tessera::master
