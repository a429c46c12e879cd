#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <vector>

#include "mediator/view/work_unit.h"

namespace tessera::node {

// The units a node has in hand: waiting, being rendered, or rendered with film still to be sent. Credits are
// absolute: places less what is in hand, so a lost message does no harm. Pure; one thread.
class WorkQueue {
  public:
    // One place per worker and as many prefetched, so that no worker waits for the network.
    explicit WorkQueue(std::uint32_t workers) : workers_(workers), places_(2 * workers) {}

    enum class Verdict {
        Taken,
        Duplicate,  // its sequence number, or a younger one, was here before: what was skipped counts as lost
        Full,       // the sender ran over the credits by far
    };
    Verdict offer(std::uint64_t sequence, const view::WorkUnit& unit);

    // The oldest waiting unit of `version`, if a worker is free; it is being rendered from then on.
    std::optional<view::WorkUnit> next(Version version);
    // The worker is free again; the unit stays in hand until released.
    std::optional<view::WorkUnit> rendered(UnitId unit);
    void release(UnitId unit);

    std::vector<view::WorkUnit> waiting() const { return {waiting_.begin(), waiting_.end()}; }
    std::vector<view::WorkUnit> rendering() const { return rendering_; }
    bool is_waiting(UnitId unit) const;
    bool is_rendering(UnitId unit) const;

    std::vector<UnitId> in_hand() const;  // ascending
    bool empty() const { return waiting_.empty() && rendering_.empty() && sending_.empty(); }
    std::uint32_t free_places() const;
    std::uint64_t last_sequence() const { return last_sequence_; }
    void restart_sequence() { last_sequence_ = 0; }  // after every welcome

  private:
    std::uint32_t workers_, places_;
    std::uint64_t last_sequence_ = 0;
    std::deque<view::WorkUnit> waiting_;
    std::vector<view::WorkUnit> rendering_;
    std::set<UnitId> sending_;
};

}  // namespace tessera::node
