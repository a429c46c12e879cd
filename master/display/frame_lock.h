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
    // An output is late when nobody became ready for so long, and for twice as long as the longest pause
    // between two in frames before (large pictures and busy machines take their time).
    Duration patience = std::chrono::milliseconds(100);
    Duration first_patience = std::chrono::seconds(5);  // nothing is known of the first frame yet
    // What a late output is given the next time, at most, however long it took.
    Duration most_patience = std::chrono::seconds(2);
    // Between the order to present and its time, at least: it must have arrived by then.
    Duration least_lead = std::chrono::milliseconds(2), most_lead = std::chrono::milliseconds(50);
};

// All outputs of a display present frame f together, in two phases: every output says that it has f ready,
// then all are told when to show it. Whoever is not ready in time is dropped from the lock: it delays
// the others once, by the patience, and is back as soon as it answers. Pure: (state, event, now) ->
// actions.
//
//   Absent   nobody shows the output          joined -> Joining
//   Joining  takes part from the next frame   begin -> Locked, if it is free
//   Locked   is waited for                    patience over -> Late · left -> Absent
//   Late     has an old frame in hand         ready, whichever frame -> Joining
class FrameLock {
  public:
    struct Output {
        session::OutputState state = session::OutputState::Absent;
        std::uint64_t in_hand = 0;  // frame that was sent and not answered; 0 = free
        TimePoint sent_at{};        // when
        Duration bound{0};          // of what is known of its clock
        std::uint64_t frames = 0, late = 0;
    };
    // What is to be told: to whom, and when to show which frame.
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

    // No frame is on its way.
    bool free() const { return frame_ == 0; }
    // A frame is sent to these outputs now. The lock is free. Who has just joined may be sent the frame that
    // the others show already.
    enum class Whom { All, Joining };
    std::vector<std::size_t> begin(std::uint64_t frame, Whom whom, TimePoint now);
    bool anybody_joins() const;
    // Frames count up; what is said of older ones only shows that the output lives.
    std::optional<Present> ready(std::size_t output, std::uint64_t frame, TimePoint now);
    // Drops who is late.
    std::optional<Present> tick(TimePoint now);
    TimePoint next_event() const { return frame_ == 0 ? TimePoint::max() : last_sign_ + patience(); }

    const std::vector<Output>& outputs() const { return outputs_; }
    std::uint64_t frames() const { return frames_; }  // presented
    double rate(TimePoint now) const;                 // a second, of late; 0 = unknown

  private:
    std::optional<Present> present_if_all_ready(TimePoint now);
    Duration patience() const {
        return expected_ ? std::max(settings_.patience, 2 * *expected_) : settings_.first_patience;
    }

    LockSettings settings_;
    Duration interval_;
    std::vector<Output> outputs_;
    std::uint64_t frame_ = 0;           // on its way; 0 = none
    bool is_new_ = false;               // nobody shows it yet
    TimePoint last_sign_{};             // of the frame: begun, or somebody was ready
    Duration pause_{0};                 // the longest between two signs
    std::optional<Duration> expected_;  // of frames before; an old one counts less and less
    std::set<std::size_t> waiting_, ready_;
    TimePoint last_at_{};
    std::vector<TimePoint> presented_;  // the latest
    std::uint64_t frames_ = 0;
};

}  // namespace tessera::master
