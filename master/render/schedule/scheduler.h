#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "master/peers/node_capacity.h"
#include "master/render/schedule/balancer.h"
#include "master/render/schedule/block_set.h"
#include "master/render/schedule/plan.h"
#include "mediator/view/work_unit.h"

namespace tessera::master {

struct Assignment {
    NodeId node;
    view::WorkUnit unit;
};
struct Cancellation {
    NodeId node;
    UnitId unit;
};

// Deals the units of one frame: (state, event, now) -> actions, without sockets or threads. Every chunk of the plan
// is dealt, merged or given back, as recorded per tile. The last units are dealt twice when a node is idle (end-game
// duplication): the first result wins, the other holder's unit is cancelled.
class Scheduler {
  public:
    // `first_unit` and later ids are this scheduler's alone.
    Scheduler(const PlanSettings& plan, ViewId view, std::uint64_t revision, Version version,
              UnitId first_unit, std::optional<TimePoint> deadline);

    std::vector<Assignment> assign(std::span<const NodeCapacity> nodes, const Balancer& balancer,
                                   TimePoint now);

    // Film of `block` of `tile` is merged; `unit` may be unknown (late, or of another holder). Cancels units of other
    // holders that are no longer needed.
    std::vector<Cancellation> merged(UnitId unit, std::uint32_t tile, const frame::SampleBlock& block);

    // The holder will send no (more) film of the unit: missing samples go back to the plan. False: unknown.
    enum class Loss { Released, Lost };
    bool released(UnitId unit, NodeId node, Loss loss);
    void node_gone(NodeId node);
    std::vector<UnitId> held_by(NodeId node) const;
    std::optional<view::WorkUnit> find(UnitId unit) const;

    // The view has a new revision: units in flight are given back, to be dealt again under it.
    std::vector<Cancellation> revise(std::uint64_t revision);

    // The scene has another version with the same samples: used for units dealt from now on.
    void follow(Version version) { version_ = version; }

    std::vector<Cancellation> cancel_everything();  // and deal no more

    // Samples from this one on are not dealt until the limit is raised; a power of two. paused(): all before
    // it is merged.
    void hold_at(std::uint64_t sample) { plan_.hold_at(sample); }
    bool paused() const { return plan_.paused() && outstanding_.empty(); }

    bool complete() const { return plan_.exhausted() && outstanding_.empty(); }
    bool idle() const { return outstanding_.empty(); }
    const std::vector<Rect>& tiles() const { return plan_.tiles(); }
    std::uint64_t merged_samples() const { return merged_samples_; }  // pixel samples
    std::uint32_t tiles_without_samples() const { return tiles_without_samples_; }
    const session::UnitCounts& counts() const { return counts_; }
    void count_duplicate() { ++counts_.duplicate; }
    void count_refused() { ++counts_.refused; }

  private:
    struct Outstanding {
        view::WorkUnit unit;
        std::uint32_t tile = 0;
        std::map<NodeId, TimePoint> holders;  // and when it was dealt
    };
    using Units = std::map<UnitId, Outstanding>;

    view::WorkUnit make_unit(const Plan::Chunk& chunk);
    std::optional<Assignment> deal(const NodeCapacity& node, const Balancer& balancer, std::uint32_t workers,
                                   std::uint32_t splits, TimePoint now);
    std::optional<Assignment> duplicate(NodeId node, const Balancer& balancer, TimePoint now);
    void cut_round_for_deadline(std::span<const NodeCapacity> nodes, const Balancer& balancer, TimePoint now);
    void drop(Units::iterator unit, NodeId node, Loss loss);

    Plan plan_;
    ViewId view_;
    std::uint64_t revision_;
    Version version_;
    std::uint64_t next_unit_;
    std::optional<TimePoint> deadline_;
    bool closed_ = false;
    Units outstanding_;
    std::vector<BlockSet> ledger_;  // per tile
    std::uint64_t merged_samples_ = 0;
    std::uint32_t tiles_without_samples_ = 0;
    session::UnitCounts counts_;
};

void add(session::UnitCounts& to, const session::UnitCounts& from);

}  // namespace tessera::master
