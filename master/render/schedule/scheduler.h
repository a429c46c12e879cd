#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "master/peers/node_capacity.h"
#include "master/render/schedule/balancer.h"
#include "master/render/schedule/forecast.h"
#include "master/render/schedule/plan.h"
#include "master/render/schedule/unit_ledger.h"
#include "mediator/view/work_unit.h"

namespace tessera::master {

struct Assignment {
    NodeId node;
    view::WorkUnit unit;
};

// A tile without (further) samples: no node could render the block.
struct TileFailure {
    std::uint32_t tile = 0;
    frame::SampleBlock block;
    std::string message;  // the latest failure
};

// Deals the units of one frame: (state, event, now) -> actions, without sockets or threads. Every chunk of the plan
// is dealt, merged or given back, as recorded in the ledger. The last units are dealt twice when a worker is idle
// (end-game duplication): the first result wins, the other holder's unit is cancelled.
class Scheduler {
  public:
    // `first_unit` and later ids are this scheduler's alone.
    Scheduler(const PlanSettings& plan, ViewId view, std::uint64_t revision, Version version,
              UnitId first_unit, std::optional<TimePoint> deadline);

    void observe_ends(UnitLedger::Observer observer) { ledger_.observe(std::move(observer)); }

    // `nodes`: all that could take units of this pass, also those without a free slot.
    std::vector<Assignment> assign(std::span<const NodeCapacity> nodes, const Balancer& balancer,
                                   TimePoint now);

    // ---- film: admit() when it arrives, then merge_ended(), and merged() or end() ----
    Admission admit(NodeId node, const ArrivingFilm& film);
    // Film that was admitted is no longer being merged, whatever came of it.
    void merge_ended() { merging_ -= merging_ > 0; }
    bool is_merging() const { return merging_ > 0; }
    // Film with further samples is dropped, so that the film stays that of merged_samples().
    void seal() { sealed_ = true; }
    // Film of `block` of `tile` is merged. Returns units of other holders that are no longer needed.
    std::vector<Cancellation> merged(NodeId node, std::uint32_t tile, const frame::SampleBlock& block) {
        return ledger_.arrived(node, tile, block);
    }
    // Film that existed before the pass began.
    void restored(std::uint32_t tile, const frame::SampleBlock& block) { (void)merged({}, tile, block); }

    // The same of an adaptive pass, further samples of some pixels.
    void restored_more(std::uint64_t pixel_samples) { ledger_.add_arrived(pixel_samples); }

    // The node will send no (more) film of the unit: missing samples go back to the plan. False: it does not hold it.
    bool end(UnitId unit, NodeId node, Fate fate);
    // The same for all units of which this film of the node has samples: it was admitted, but not merged.
    void end_film(NodeId node, std::uint32_t tile, const frame::SampleBlock& block, Fate fate);
    // The node could not render the unit. A tile that fails on two nodes is given up: see failed_tiles().
    bool failed(UnitId unit, NodeId node, UnitTrouble::Kind kind, const std::string& message);
    // `workers`: how many units it may have been rendering when it vanished; 0: it left in order.
    void node_gone(const UnitLedger::Loss& loss);
    void came_back(NodeId node) { ledger_.came_back(node); }  // under another id
    std::vector<UnitId> held_by(NodeId node) const { return ledger_.held_by(node); }
    const UnitLedger& ledger() const { return ledger_; }

    // Failures on nodes that have been explained since the last call: by another node's success, or as the tile's fault.
    std::vector<UnitLedger::Explained> take_explained() { return ledger_.take_explained(); }
    const std::vector<TileFailure>& failed_tiles() const { return failed_tiles_; }
    void give_up(const TileFailure& tile);  // gets no (more) samples

    // The view has a new revision: units in flight are given back, to be dealt again under it.
    std::vector<Cancellation> revise(std::uint64_t revision);

    // The scene has another version with the same samples: used for units dealt from now on.
    void follow(Version version) { version_ = version; }

    std::vector<Cancellation> cancel_everything();  // and deal no more

    // Samples from this one on are not dealt until the limit is raised; a power of two. paused(): all before
    // it is merged.
    void hold_at(std::uint64_t sample) { plan_.hold_at(sample); }
    // An adaptive plan, when paused(): goes on with these rounds, or is complete without any.
    void begin_step(std::vector<Round> rounds);
    bool paused() const { return plan_.paused() && ledger_.is_idle(); }

    bool complete() const { return plan_.exhausted() && ledger_.is_idle(); }
    bool idle() const { return ledger_.is_idle(); }
    const std::vector<Rect>& tiles() const { return plan_.tiles(); }
    std::span<const Round> rounds() const { return plan_.rounds(); }
    std::uint64_t merged_samples() const { return ledger_.arrived_samples(); }  // pixel samples
    std::uint64_t remaining_samples() const { return plan_.remaining_samples(); }
    // Those that still may get some.
    std::uint32_t tiles_without_samples() const;
    // Once the pass is complete or cancelled, units in flight count as cancelled.
    session::UnitCounts counts() const;

  private:
    struct Turn;  // of assign()
    class DoubtfulTiles;
    view::WorkUnit make_unit(const Plan::Chunk& chunk) const;
    bool may_take_more(const NodeCapacity& node, const Turn& turn) const;
    std::optional<Assignment> deal(const NodeCapacity& node, Turn& turn);
    std::optional<Plan::Chunk> next_chunk(const NodeCapacity& node, Turn& turn);
    bool keeps_others_waiting(const NodeCapacity& node, const Plan::Chunk& chunk, const Turn& turn) const;
    bool take_over_a_claim(const NodeCapacity& node, Turn& turn);
    std::optional<Assignment> deal_overdue(const NodeCapacity& node, Turn& turn);
    std::optional<Assignment> duplicate(const NodeCapacity& node, Turn& turn,
                                        const std::function<bool(const Forecast::Awaited&, double)>& may_be);
    double seconds_left(const Turn& turn) const;
    const Forecast& forecast(Turn& turn) const;
    void release_claims_of_others(std::span<const NodeCapacity> nodes);
    void cut_round_for_deadline(const Turn& turn);
    void collect_returned();

    Plan plan_;
    ViewId view_;
    std::uint64_t revision_;
    Version version_;
    std::optional<TimePoint> deadline_;
    bool closed_ = false, sealed_ = false;
    std::uint32_t merging_ = 0;
    UnitLedger ledger_;
    std::vector<TileFailure> failed_tiles_;
    std::uint64_t issued_ = 0, reissued_ = 0;
};

void add(session::UnitCounts& to, const session::UnitCounts& from);

}  // namespace tessera::master
