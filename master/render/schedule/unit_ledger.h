#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "master/render/schedule/block_set.h"
#include "master/render/schedule/unit_trouble.h"
#include "mediator/base/clock.h"
#include "mediator/session/view_summary.h"
#include "mediator/view/work_unit.h"

namespace tessera::master {

struct Cancellation {
    NodeId node;
    UnitId unit;
};

// How a node's part in a unit ended. Every unit dealt to a node (issued or reissued) ends once:
// issued + reissued = merged + duplicate + cancelled + refused + lost + those in flight.
enum class Fate : std::uint8_t {
    Merged,     // its film completed the unit
    Duplicate,  // its film was not needed: the samples had arrived from another node
    Cancelled,  // released, or stopped early
    Refused,    // the node could not render it, or its film was not admitted
    Lost,       // the node is gone, or its film never arrived
};
constexpr auto enumerators(Fate) {
    return std::to_array<std::string_view>({"merged", "duplicate", "cancelled", "refused", "lost"});
}

// What the header of a film message says.
struct ArrivingFilm {
    UnitId unit;
    Version version;
    Rect rect;
    frame::SampleBlock block;
    std::string mask;  // as WorkUnit's
};

struct Admission {
    std::string problem;  // why it is not admitted: the sender invents film. Empty: admitted
    std::uint32_t tile = 0;
    // Samples of this tile that arrived earlier as parts of the same units; the film may replace blocks of these alone.
    BlockSet replaceable;
    // Whether it is merged, and its bits are hashed to verify them or because they verify others', or it comes too late.
    enum class Use : std::uint8_t { Merge, MergeAndHash, Compare, Drop };
    Use use = Use::Merge;
};

// The units of a pass from the moment they are dealt: which nodes hold them, which samples of each tile have arrived, and
// how each ended. Film is admitted from a node if units that it holds or held cover it. Pure.
class UnitLedger {
  public:
    // Samples whose holders are gone: to be dealt again.
    struct Returned {
        std::uint32_t tile = 0;
        frame::SampleBlock block;
        std::shared_ptr<const UnitTrouble> trouble;  // null: none
    };
    // A failure is explained: another node has rendered the samples, or they are to blame themselves.
    struct Explained {
        NodeId node;
        bool is_to_blame = false;  // another node managed what this one failed
        std::string message;
    };
    struct Loss {
        NodeId node;
        std::uint32_t rendering = 0;  // how many of its oldest units it may have been rendering
        bool has_ended = false;       // its process, as its connection says; else it is silent
        TimePoint now{};
        std::function<std::string(const view::WorkUnit&)> describe;  // the failure of a unit, for its user
    };
    struct Unit {
        view::WorkUnit unit;
        std::uint32_t tile = 0;
        std::map<NodeId, TimePoint> holders;  // since when
        std::vector<NodeId> past_holders;
        std::shared_ptr<const UnitTrouble> trouble;
        BlockSet parts;           // admitted so far
        bool is_covered = false;  // all its samples have arrived; the remaining holders are being stopped
    };

    using Observer = std::function<void(const view::WorkUnit&, NodeId, Fate)>;

    // Units have ids from `first_unit` on, in the order of deal().
    // max_crashes: nodes that samples may cost before they are to blame.
    UnitLedger(std::vector<Rect> tiles, UnitId first_unit, std::size_t max_crashes);

    // Called at the end of each node's part in a unit.
    void observe(Observer observer) { observer_ = std::move(observer); }

    const std::vector<Rect>& tiles() const { return tiles_; }
    UnitId next_unit() const { return UnitId{first_unit_.value + dealt_.size()}; }

    void deal(const view::WorkUnit& unit, std::uint32_t tile, std::shared_ptr<const UnitTrouble> trouble,
              NodeId node, TimePoint now);
    void deal_again(UnitId unit, NodeId node, TimePoint now);

    void add_arrived(std::uint64_t pixel_samples) { arrived_samples_ += pixel_samples; }

    // Everything dealt so far has arrived; the same samples may be dealt again, for other pixels.
    void begin_step();

    Admission admit(NodeId node, const ArrivingFilm& film);
    // Film of the node was merged, or was there already. Returns the holders whose work is no longer needed.
    std::vector<Cancellation> arrived(NodeId node, std::uint32_t tile, const frame::SampleBlock& block);

    // The node's part in the unit ends; missing samples are returned. False: it does not hold the unit.
    bool end(UnitId unit, NodeId node, Fate fate);
    // The same for its units of which the block has samples: that film was admitted, but not merged.
    void end_film(NodeId node, std::uint32_t tile, const frame::SampleBlock& block, Fate fate);
    bool fail(UnitId unit, NodeId node, UnitTrouble::Kind kind, const std::string& message);
    // All its units are lost. If its process ended, and of those that it rendered one had cost more nodes before than any
    // other, that one has killed it.
    void node_gone(const Loss& loss);
    void came_back(NodeId node) { survivors_.insert(node); }  // a lost one: it had lost its connection
    bool is_settled(const UnitTrouble& trouble) const {
        return trouble.is_settled(max_crashes_, survivors_, other_losses(trouble));
    }
    // It has cost two nodes, but nothing says that others did not: see UnitTrouble.
    bool is_suspect(const std::shared_ptr<const UnitTrouble>& trouble) const { return lives(trouble) >= 2; }
    bool holds_suspect(NodeId node) const;
    std::size_t lives(const std::shared_ptr<const UnitTrouble>& trouble) const {
        return trouble ? trouble->lives(survivors_) : 0;
    }
    bool has_losses() const { return has_losses_; }
    // Another node has samples of the tile that may have cost one.
    bool others_have_doubtful(std::uint32_t tile, NodeId node) const;
    // Ends all units; film of theirs is no longer admitted. Returns their holders.
    std::vector<Cancellation> end_all();
    // The samples of `trouble` are to blame.
    void blame_samples(const std::shared_ptr<const UnitTrouble>& trouble);

    std::vector<Returned> take_returned() { return std::exchange(returned_, {}); }
    std::vector<Explained> take_explained() { return std::exchange(explained_, {}); }

    const Unit* find(UnitId unit) const;
    const std::map<UnitId, Unit>& open() const { return open_; }
    std::vector<Cancellation> holders() const;  // of all open units
    std::vector<UnitId> held_by(NodeId node) const;
    struct Load {
        std::size_t units = 0;
        std::uint64_t samples = 0;  // pixel samples
    };
    Load load(NodeId node) const;  // all that it holds
    std::uint32_t unexplained_failures(NodeId node) const;
    const BlockSet& samples(std::uint32_t tile) const { return arrived_[tile]; }  // of the current step
    bool has_samples(std::uint32_t tile) const { return has_samples_[tile]; }
    bool is_idle() const { return uncovered_ == 0; }                    // no samples are awaited
    std::uint64_t arrived_samples() const { return arrived_samples_; }  // pixel samples
    std::uint32_t tiles_without_samples() const { return tiles_without_samples_; }
    const session::UnitCounts& counts() const { return counts_; }
    std::uint64_t in_flight() const { return in_flight_; }  // units times holders

  private:
    struct Dealt {
        NodeId node;  // its first holder
        std::uint32_t tile = 0;
    };
    std::size_t pixel_count(std::uint32_t tile, const frame::SampleBlock& block) const;
    bool was_dealt_to(NodeId node, UnitId unit) const;
    void hold(UnitId id, Unit& unit, NodeId node, TimePoint now);
    void close(std::map<UnitId, Unit>::iterator entry, NodeId node, Fate fate);
    void forget_former(std::uint32_t tile);
    std::size_t other_losses(const UnitTrouble& trouble) const;
    std::optional<UnitId> most_suspect(const std::vector<UnitId>& units) const;
    void explain(const std::shared_ptr<const UnitTrouble>& trouble, bool nodes_are_to_blame);
    template <class Visit>
    void for_each_of(NodeId node, std::uint32_t tile, const Visit& visit);

    std::vector<Rect> tiles_;
    UnitId first_unit_;
    std::size_t max_crashes_;
    std::vector<Dealt> dealt_;                        // by unit
    std::map<UnitId, std::set<NodeId>> dealt_again_;  // further holders
    std::map<UnitId, Unit> open_;
    std::map<UnitId, Unit>
        former_;  // ended before all samples had arrived: film may still be under way. Bounded
    std::vector<std::vector<UnitId>> open_of_tile_, former_of_tile_;
    struct Held {
        std::set<UnitId> units;
        std::uint64_t samples = 0;
    };
    std::map<NodeId, Held> by_node_;
    std::vector<BlockSet> arrived_;  // by tile, of the current step
    std::vector<bool> has_samples_;  // by tile
    UnitId step_begin_{};            // its first unit
    std::set<std::shared_ptr<const UnitTrouble>> unexplained_;
    std::set<NodeId> lost_;  // and nothing explains it yet
    std::set<NodeId> survivors_;
    bool has_losses_ = false;
    std::vector<Returned> returned_;
    std::vector<Explained> explained_;
    std::uint64_t arrived_samples_ = 0, in_flight_ = 0;
    std::uint32_t tiles_without_samples_, uncovered_ = 0;
    session::UnitCounts counts_;
    Observer observer_;
};

}  // namespace tessera::master
