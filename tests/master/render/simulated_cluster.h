#pragma once

#include <map>
#include <queue>
#include <vector>

#include "master/peers/node_table.h"
#include "master/render/schedule/scheduler.h"
#include "tests/master/render/simulated_node.h"

namespace tessera::master {

// A cluster in simulated time: the master's scheduler, balancer, and table of nodes, which says who is silent or stuck, and
// nodes that behave as real ones do. Messages between them take time, so the master's view of a node lags. Like the real
// master it handles what has arrived in turns, and deals at the end of each.
class SimulatedCluster {
  public:
    using Node = SimulatedNodeSettings;

    SimulatedCluster(const std::vector<Node>& nodes, const PlanSettings& plan);

    double run();  // to the end, or until no node is left; returns the time in s

    // When the samples would have been rendered if every worker had rendered needed ones at its rate all the time, from the
    // start until it died, and whatever it had rendered had been used: work / sum of the rates, if these are constant.
    double ideal_time() const;

    const Scheduler& scheduler() const { return scheduler_; }
    // The accepted blocks of each tile are disjoint and have all samples.
    bool is_covered(std::uint64_t spp) const;
    std::uint64_t films() const { return films_; }            // messages that arrived
    std::uint64_t refused_films() const { return refused_; }  // not admitted
    double duplicated_samples() const;  // rendered, and there already or not wanted any more
    std::uint64_t samples_of(std::size_t node) const { return members_[node].node.samples(); }

  private:
    using Unit = SimulatedNode::Unit;
    using Message = SimulatedNode::Message;
    struct Member {
        SimulatedNode node;
        NodeId id;               // the master's: another one after each join
        std::uint32_t life = 0;  // joins and deaths so far
        // As far as the master knows:
        std::uint32_t occupied = 0;   // slots
        std::uint32_t in_flight = 0;  // units whose film or release has not arrived
        bool is_known = false, is_stuck = false, has_sent_film = false;
        bool rejoins = false;
        double hold_limit = 0.0;  // when it will look for film that was held for long enough
    };
    enum class Kind : std::uint8_t {
        // at a node
        Work,
        Cancel,
        Finish,
        HoldLimit,
        HeartbeatDue,
        // at the master
        Message,
        Heartbeat,
        ConnectionEnds,
        Join,
        Turn,
        Tick
    };
    struct Event {
        double at;
        std::uint64_t order;
        Kind kind;
        std::uint32_t member = 0, life = 0;
        UnitId unit{};
        Message message{};
        std::uint64_t progress = 0;
        bool works = false;
        friend bool operator>(const Event& a, const Event& b) {
            return a.at != b.at ? a.at > b.at : a.order > b.order;
        }
    };

    void handle(const Event& event);
    void handle_at_node(const Event& event);
    void after(Member& member);
    void beat(Member& member);
    void join(Member& member);
    void message(Member& member, const Message& message);
    void film(Member& member, const SimulatedNode::Film& film);
    std::optional<std::uint64_t> accept(std::uint32_t tile, const frame::SampleBlock& block,
                                        const BlockSet& replaceable);
    void heartbeat(Member& member, const Event& event);
    Duration allowance(const Member& member) const;
    void unknown(Member& member);
    void lose(Member& member, bool has_ended);
    void tick();
    void deal();
    void next_turn();
    void send(Member& member, Kind kind, UnitId unit);
    static double awake(const Member& member, double time);  // then, or when the node goes on
    void schedule(double at, Kind kind, const Member* member = nullptr, UnitId unit = {},
                  const Message& message = {});
    std::uint32_t index(const Member& member) const {
        return static_cast<std::uint32_t>(&member - members_.data());
    }
    Unit& unit(UnitId id) { return units_[id.value - 1]; }
    static TimePoint time_point(double time) {
        return TimePoint(Duration(static_cast<std::int64_t>(time * 1e9)));
    }

    std::vector<Member> members_;
    std::uint32_t tile_edge_, columns_;
    double work_ = 0.0, hold_film_;
    Scheduler scheduler_;
    Balancer balancer_;
    NodeTable table_;
    std::vector<NodeCapacity> capacities_;
    std::map<NodeId, std::uint32_t> by_id_;
    std::vector<Unit> units_;                                       // by id
    std::vector<std::map<std::uint64_t, std::uint32_t>> accepted_;  // blocks by tile: level by first sample
    std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
    std::uint64_t order_ = 0, next_id_ = 1, films_ = 0, refused_ = 0, covered_twice_ = 0;
    double now_ = 0.0;
    bool has_turn_ = false;
};

}  // namespace tessera::master
