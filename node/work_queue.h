#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <vector>

#include "mediator/view/work_unit.h"

namespace tessera::node {

// The units in flight on a node: waiting, being rendered, or rendered with film held or still to be sent. Credits are absolute
// (slots less units in flight), so a lost message does no harm. Pure; single-threaded.
class WorkQueue {
  public:
    // One slot per worker and as many for prefetched units, so that no worker waits for the network.
    explicit WorkQueue(std::uint32_t workers) : workers_(workers), slots_(2 * workers) {}

    enum class AdmitResult {
        Accepted,
        Duplicate,  // its sequence number or a later one was seen before: skipped numbers count as lost
        Full,       // the sender exceeded the credits by far
    };
    AdmitResult admit(std::uint64_t sequence, const view::WorkUnit& unit);

    // The oldest waiting unit of `version`, if a worker is free; it counts as being rendered from then on.
    std::optional<view::WorkUnit> next(Version version);
    // The worker is free again; the unit stays in flight until released.
    std::optional<view::WorkUnit> rendered(UnitId unit);
    // Its film waits for that of another unit, and takes no slot meanwhile; then it is sent.
    void hold(UnitId unit);
    void unhold(UnitId unit);
    void release(UnitId unit);

    std::vector<view::WorkUnit> waiting() const { return {waiting_.begin(), waiting_.end()}; }
    std::vector<view::WorkUnit> rendering() const { return rendering_; }
    bool is_waiting(UnitId unit) const;
    bool is_rendering(UnitId unit) const;
    bool is_sending(UnitId unit) const { return sending_.contains(unit); }

    std::vector<UnitId> in_flight() const;  // ascending
    bool empty() const { return waiting_.empty() && rendering_.empty() && held_.empty() && sending_.empty(); }
    std::uint32_t free_slots() const;
    std::uint64_t last_sequence() const { return last_sequence_; }
    void restart_sequence() { last_sequence_ = 0; }  // after every welcome

  private:
    std::uint32_t workers_, slots_;
    std::uint64_t last_sequence_ = 0;
    std::deque<view::WorkUnit> waiting_;
    std::vector<view::WorkUnit> rendering_;
    std::set<UnitId> held_, sending_;
};

}  // namespace tessera::node
