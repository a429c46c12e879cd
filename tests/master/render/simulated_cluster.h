#pragma once

#include <deque>
#include <map>
#include <set>
#include <vector>

#include "master/render/schedule/scheduler.h"

namespace tessera::master {

// A cluster in simulated time: each worker renders at its own rate, messages to and from a node take time, and nodes hold
// film back to merge it, as real ones do. The scheduler's view of a node lags by the latency.
class SimulatedCluster {
  public:
    struct Node {
        double rate = 1e5;  // pixel samples per second of each worker
        std::uint32_t workers = 1;
        double latency = 0.0;  // s, one way
        double dies_at = 1e9, slow_from = 1e9, slow_factor = 1.0;
        std::set<std::uint32_t> fails_on;  // tiles
    };

    SimulatedCluster(std::vector<Node> nodes, const PlanSettings& plan);

    double run();  // to the end, or until no node is alive; returns the time in s

    const Scheduler& scheduler() const { return scheduler_; }
    bool is_covered(std::uint64_t spp) const;
    std::uint64_t films() const { return films_; }        // messages that arrived
    std::uint64_t rendered() const { return rendered_; }  // pixel samples, by all nodes
    std::uint64_t samples_of(std::size_t node) const { return nodes_[node].samples; }

  private:
    struct Running {
        view::WorkUnit unit;
        double done_at;
    };
    struct Film {
        std::uint32_t tile;
        frame::SampleBlock block;
    };
    struct State {
        Node node;
        bool is_alive = true;
        std::deque<view::WorkUnit> waiting;
        std::vector<Running> running;
        std::vector<Film> held;
        std::uint64_t samples = 0;
        std::uint32_t known_in_flight = 0;  // to the scheduler
    };
    enum class Kind { WorkArrives, FilmArrives, FailureArrives, CancelArrives, SlotIsFree };
    struct Event {
        Kind kind;
        std::size_t node;
        view::WorkUnit unit;
        Film film{};
        std::uint32_t units = 0;
    };

    void deal();
    void start_workers(State& state);
    void finish(std::size_t who, std::size_t running);
    void hold(std::size_t who, Film film, bool flush);
    void handle(const Event& event);
    void kill(std::size_t who);
    void later(double after, Event event) { events_.emplace(now_ + after, std::move(event)); }
    double rate(const State& state) const;
    std::uint32_t tile_of(const view::WorkUnit& unit) const;
    static TimePoint at(double time) { return TimePoint(Duration(static_cast<std::int64_t>(time * 1e9))); }

    std::vector<State> nodes_;
    Scheduler scheduler_;
    Balancer balancer_;
    std::vector<BlockSet> coverage_;
    std::multimap<double, Event> events_;
    double now_ = 0.0;
    std::uint64_t films_ = 0, rendered_ = 0;
};

}  // namespace tessera::master
