#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "master/peers/quarantine.h"
#include "master/render/schedule/unit_ledger.h"
#include "mediator/base/hash.h"
#include "mediator/base/random.h"
#include "mediator/view/view.h"

namespace tessera::master {

struct VerifierSettings {
    double share = 0.0;      // of the film that nodes send, 0 to 1
    std::uint64_t seed = 1;  // secret, so that nodes cannot tell which film will be verified
    Duration patience = std::chrono::seconds(60);  // for a node that could verify it
};

// Has film rendered again by other nodes of the same kind and compares the bits. If two nodes differ, a third one
// decides which of them is wrong. A verification is dealt as a unit of a view of its own (view_of()): its film is compared and
// never merged. Pure.
class Verifier {
  public:
    struct Witness {
        NodeId node;
        Quarantine::Key identity;
        Hash256 film;
    };
    struct Task {
        std::shared_ptr<const view::View> view;  // its id is view_of(pass)
        Version version;
        std::string kind;
        Rect tile;
        frame::SampleBlock block;
        UnitId verified;  // the unit, or the last of the units, whose film it was
        std::uint32_t units = 1;
        TimePoint since{};
        std::vector<Witness> witnesses{};
        std::set<NodeId> asked{};  // all that have or had it
    };
    enum class Outcome : std::uint8_t {
        Agreed,
        Differs,   // the second from the first: a third is asked
        OneIsOdd,  // two of the three agree
        AllDiffer
    };
    struct Finding {
        Outcome outcome = Outcome::Agreed;
        Task task;
        std::optional<Witness> odd;
    };
    struct Dealt {
        view::WorkUnit unit;
        std::shared_ptr<const view::View> view;
    };

    explicit Verifier(const VerifierSettings& settings) : settings_(settings), random_(settings.seed) {}

    static ViewId view_of(ViewId pass) { return ViewId{pass.value | ViewBit}; }
    static bool is_verification(ViewId view) { return (view.value & ViewBit) != 0; }
    static ViewId pass_of(ViewId view) { return ViewId{view.value & ~ViewBit}; }
    static bool owns(UnitId unit) { return unit.value >= FirstUnit; }
    bool is_on() const { return settings_.share > 0.0; }

    bool chooses_next();  // at random: whether the film that has arrived is to be verified
    void add(Task task, const Witness& first);
    void follow(ViewId view, Version version);      // with the same samples
    std::vector<Cancellation> forget(ViewId view);  // all its tasks
    void drop_old(TimePoint now);                   // tasks for which no node was found in time
    bool uses(ViewId view) const;

    // The oldest task that the node may take, as far as it has not been asked. A node has one of each tile at a time, since
    // it would merge the film of neighbouring blocks.
    std::optional<Dealt> deal(NodeId node, const std::function<bool(const Task&)>& may);
    bool was_dealt(UnitId unit) const { return owns(unit) && unit.value < next_unit_; }
    const Task* held(UnitId unit, NodeId node) const;  // null: it does not hold it
    std::vector<UnitId> held_by(NodeId node) const;
    std::vector<std::pair<UnitId, const Task*>> tasks_of(NodeId node) const;
    // Its film has arrived.
    std::optional<Finding> take(UnitId unit, const Witness& witness);
    bool end(UnitId unit, NodeId node);  // without film: another node gets it. False: it does not hold it
    void node_gone(NodeId node);

  private:
    static constexpr std::uint64_t ViewBit = std::uint64_t{1} << 62, FirstUnit = std::uint64_t{1} << 62;
    static constexpr std::size_t MaxTasks = 4096;

    VerifierSettings settings_;
    CounterRandom random_;
    std::deque<Task> waiting_;
    struct Held {
        NodeId node;
        Task task;
    };
    std::map<UnitId, Held> held_;
    std::uint64_t next_unit_ = FirstUnit;
};

}  // namespace tessera::master
