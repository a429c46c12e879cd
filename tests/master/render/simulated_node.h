#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "mediator/base/ids.h"
#include "mediator/frame/sample_block.h"

namespace tessera::master {

// What one node of a simulated cluster is like, and what happens to it. Times are in s.
struct SimulatedNodeSettings {
    static constexpr double Never = 1e9;

    double rate = 1e5;  // pixel samples per second of each worker
    std::uint32_t workers = 1;
    double latency = 0.0;  // one way
    double dies_at = Never, slow_from = Never, slow_factor = 1.0;
    std::set<std::uint32_t> fails_on;  // tiles
    bool dies_silently = false;        // the machine is gone; else the process, and its connection ends
    // It stands still for a while: its process, which is silent meanwhile, or only its workers.
    double stalls_at = Never, stalls_for = 0.0;
    bool only_workers_stall = false;

    bool is_deaf(double time) const {
        return !only_workers_stall && time >= stalls_at && time < stalls_at + stalls_for;
    }
};

// The rate of one worker over time.
class WorkerRate {
  public:
    explicit WorkerRate(const SimulatedNodeSettings& node);

    double rendered(double from, double to) const;          // pixel samples
    double time_after(double start, double samples) const;  // when that many are rendered, or Never

  private:
    struct Step {
        double from, rate;
    };
    std::vector<Step> steps_;
};

// The node's side of a simulated cluster: renders units in the order in which they arrive, merges their film with that of
// sibling blocks in hand, and stops what is cancelled, as node/ does. Time is an argument; messages are collected.
class SimulatedNode {
  public:
    struct Unit {
        UnitId id;
        std::uint32_t tile = 0;
        frame::SampleBlock block;
        std::uint64_t samples = 0;  // pixel samples
    };
    struct Film {
        UnitId unit{};  // one of those that it is of
        std::uint32_t tile = 0;
        frame::SampleBlock block;
        std::uint64_t samples = 0;
        double busy = 0.0, since = 0.0;
        std::uint32_t units = 0;
    };
    struct Message {
        enum class Kind : std::uint8_t {
            SlotIsFree,
            Film,
            Released,  // cancelled, before it was rendered or sent
            Failed
        };
        Kind kind;
        UnitId unit;
        Film film{};
    };
    struct Start {
        UnitId unit;
        double done_at;
    };

    SimulatedNode(const SimulatedNodeSettings& settings, double hold_film)
        : settings_(settings), rate_(settings), hold_film_(hold_film) {}

    const SimulatedNodeSettings& settings() const { return settings_; }
    const WorkerRate& rate() const { return rate_; }

    void work(const Unit& unit, double now);
    void finish(UnitId unit, double now);  // nothing if it was stopped meanwhile
    void cancel(const Unit& unit, double now);
    void send_ready(double now);  // film that was held for long enough
    void forget_everything(double now);

    std::vector<Message> take_messages() { return std::exchange(messages_, {}); }
    std::vector<Start> take_starts() { return std::exchange(starts_, {}); }
    std::optional<double> oldest_film() const;
    bool is_idle() const { return waiting_.empty() && running_.empty() && held_.empty(); }
    std::uint64_t samples() const { return samples_; }  // of finished units
    double wasted_samples() const {
        return wasted_samples_;
    }  // of units that were stopped, or whose film was dropped

  private:
    struct Running {
        Unit unit;
        double start;
    };
    void start_workers(double now);
    void hold(Film film, double now);
    bool other_half_is_coming(const Film& film) const;

    SimulatedNodeSettings settings_;
    WorkerRate rate_;
    double hold_film_;
    std::deque<Unit> waiting_;
    std::vector<Running> running_;
    std::vector<Film> held_;
    std::vector<Message> messages_;
    std::vector<Start> starts_;
    std::uint64_t samples_ = 0;
    double wasted_samples_ = 0.0;
};

}  // namespace tessera::master
