#include "master/render/schedule/scheduler.h"

#include <algorithm>

namespace tessera::master {

using frame::SampleBlock;

// What does not change while units are dealt.
struct Scheduler::Turn {
    Turn(std::span<const NodeCapacity> all, const Balancer& rates, TimePoint time)
        : nodes(all), balancer(rates), now(time) {
        for (const NodeCapacity& node : nodes) {
            workers += node.workers;
            rate += node.workers * balancer.rate(node.node);
            assumed_rate += node.workers * balancer.assumed_rate(node.node);
        }
    }
    const NodeCapacity* find(NodeId id) const {
        const auto node = std::ranges::find(nodes, id, &NodeCapacity::node);
        return node == nodes.end() ? nullptr : &*node;
    }

    std::span<const NodeCapacity> nodes;
    const Balancer& balancer;
    TimePoint now;
    std::uint32_t workers = 0;
    double rate = 0.0, assumed_rate = 0.0;  // pixel samples per second of all
    std::optional<Forecast> forecast;       // made when it is needed
};

Scheduler::Scheduler(const PlanSettings& plan, ViewId view, std::uint64_t revision, Version version,
                     UnitId first_unit, std::optional<TimePoint> deadline)
    : plan_(plan),
      view_(view),
      revision_(revision),
      version_(version),
      deadline_(deadline),
      ledger_(plan_.tiles(), first_unit, plan.max_crashes) {}

view::WorkUnit Scheduler::make_unit(const Plan::Chunk& chunk) const {
    const RoundMask* mask = plan_.mask(chunk.tile, chunk.block.first);
    return {.id = ledger_.next_unit(),
            .view = view_,
            .revision = revision_,
            .version = version_,
            .tile = plan_.tiles()[chunk.tile],
            .block = chunk.block,
            .mask = mask != nullptr ? mask->bits : ""};
}

// ---- dealing ----

std::vector<Assignment> Scheduler::assign(std::span<const NodeCapacity> nodes, const Balancer& balancer,
                                          TimePoint now) {
    std::vector<Assignment> assignments;
    if (closed_) return assignments;
    release_claims_of_others(nodes);
    Turn turn(nodes, balancer, now);
    std::vector<NodeCapacity> capacities(nodes.begin(), nodes.end());
    // One unit per turn, so that one node's prefetch does not empty the plan while another starves.
    for (bool dealt = true; dealt;) {
        dealt = false;
        for (NodeCapacity& node : capacities) {
            if (!may_take_more(node, turn)) continue;
            cut_round_for_deadline(turn);
            auto assignment = deal_overdue(node, turn);
            if (!assignment) assignment = deal(node, turn);
            const bool has_idle_worker = node.in_flight < node.workers || node.free_slots > node.workers;
            if (!assignment && has_idle_worker)
                assignment = duplicate(node, turn, [](const auto&, double) { return true; });
            if (!assignment) continue;
            node.free_slots -= std::min(node.free_slots, 1u);
            ++node.in_flight;
            assignments.push_back(std::move(*assignment));
            dealt = true;
        }
    }
    return assignments;
}

// Its workers must not wait for the network, so it has work in hand for that time and a unit more. Two units for each
// worker are enough for that, which the node grants itself, unless they are short.
bool Scheduler::may_take_more(const NodeCapacity& node, const Turn& turn) const {
    constexpr std::size_t MaxBeyondSlots = 32;  // node/work_queue.h takes 64
    if (node.free_slots > 0) return true;
    const UnitLedger::Load load = ledger_.load(node.node);
    const std::size_t slots = 2 * std::size_t{node.workers};
    if (node.in_flight > load.units || load.units < slots || load.units >= slots + MaxBeyondSlots)
        return false;
    const double time =
        node.round_trip_seconds + std::min(turn.balancer.unit_seconds(), 0.5 * seconds_left(turn));
    return static_cast<double>(load.samples) < time * node.workers * turn.balancer.rate(node.node);
}

// All nodes together, for what has not been dealt.
double Scheduler::seconds_left(const Turn& turn) const {
    return turn.assumed_rate > 0.0 ? static_cast<double>(plan_.remaining_samples()) / turn.assumed_rate : 0.0;
}

const Forecast& Scheduler::forecast(Turn& turn) const {
    if (!turn.forecast) turn.forecast.emplace(ledger_, turn.nodes, turn.balancer, turn.now);
    return *turn.forecast;
}

std::optional<Assignment> Scheduler::deal(const NodeCapacity& node, Turn& turn) {
    while (auto chunk = next_chunk(node, turn)) {
        // Film that was considered lost may have arrived after all.
        const std::vector<SampleBlock> gaps = ledger_.samples(chunk->tile).missing_in(chunk->block);
        if (gaps.size() != 1 || gaps.front() != chunk->block) {
            for (const SampleBlock& gap : gaps) {
                Plan::Chunk part = *chunk;
                part.block = gap;
                plan_.give_back(part);
            }
            continue;
        }
        const view::WorkUnit unit = make_unit(*chunk);
        ++(chunk->again ? reissued_ : issued_);
        ledger_.deal(unit, chunk->tile, std::move(chunk->trouble), node.node, turn.now);
        return Assignment{node.node, unit};
    }
    return std::nullopt;
}

// Of a tile with samples that may have cost a node, these are dealt first, and to one node at a time; so the next loss
// says more, and costs no further node.
class Scheduler::DoubtfulTiles {
  public:
    DoubtfulTiles(const Scheduler& scheduler, NodeId node) : ledger_(scheduler.ledger_), node_(node) {
        if (!ledger_.has_losses()) return;
        has_suspect_ = ledger_.holds_suspect(node);
        for (const Plan::Chunk& chunk : scheduler.plan_.returned()) {
            if (ledger_.lives(chunk.trouble) > 0) waiting_.insert(chunk.tile);
        }
    }
    bool may_go(const Plan::Chunk& chunk) const {
        if (!ledger_.has_losses()) return true;
        if (has_suspect_ && ledger_.is_suspect(chunk.trouble)) return false;
        const bool waits_for_others = ledger_.lives(chunk.trouble) == 0 && waiting_.contains(chunk.tile);
        return !waits_for_others && !ledger_.others_have_doubtful(chunk.tile, node_);
    }

  private:
    const UnitLedger& ledger_;
    NodeId node_;
    bool has_suspect_ = false;
    std::set<std::uint32_t> waiting_;
};

// A slow node would, with samples that go to one node at a time. Measured by the middle of all nodes: one that claims to be
// the fastest and takes nothing keeps them from no other.
bool Scheduler::keeps_others_waiting(const NodeCapacity& node, const Plan::Chunk& chunk,
                                     const Turn& turn) const {
    if (ledger_.lives(chunk.trouble) == 0) return false;
    std::vector<double> rates;
    for (const NodeCapacity& other : turn.nodes) {
        if (!chunk.trouble->has_failed_on(other.node)) rates.push_back(turn.balancer.rate(other.node));
    }
    if (rates.empty()) return false;
    const auto middle = rates.begin() + static_cast<std::ptrdiff_t>((rates.size() - 1) / 2);
    std::ranges::nth_element(rates, middle);
    return turn.balancer.rate(node.node) < 0.5 * *middle;
}

std::optional<Plan::Chunk> Scheduler::next_chunk(const NodeCapacity& node, Turn& turn) {
    const std::uint64_t samples = turn.balancer.unit_samples(node.node, seconds_left(turn));
    const std::size_t pixels =
        std::max<std::size_t>(1, plan_.tiles().empty() ? 1 : plan_.tiles()[0].pixel_count());
    const std::uint64_t count = std::max<std::uint64_t>(1, samples / pixels);
    const auto node_count = static_cast<std::uint32_t>(turn.nodes.size());
    for (;;) {
        if (!plan_.returned().empty()) {
            const DoubtfulTiles doubtful(*this, node.node);
            // What failed on a node goes to another one, unless there is none.
            const auto may_go = [&](const Plan::Chunk& chunk) {
                if (!doubtful.may_go(chunk) || keeps_others_waiting(node, chunk, turn)) return false;
                return !chunk.trouble || !chunk.trouble->has_failed_on(node.node) ||
                       std::ranges::all_of(turn.nodes, [&](const NodeCapacity& other) {
                           return chunk.trouble->has_failed_on(other.node);
                       });
            };
            if (auto chunk = plan_.next_returned(count, may_go)) return chunk;
        }
        if (auto chunk = plan_.next(node.node, count, node_count, turn.workers)) return chunk;
        if (!take_over_a_claim(node, turn)) return std::nullopt;
    }
}

// No samples are left to claim: an idle node takes a part of the claim that would be finished last, if that is sooner.
bool Scheduler::take_over_a_claim(const NodeCapacity& node, Turn& turn) {
    // Each part costs the network one more film: the last units are not split, but dealt twice if they are late.
    const double min_seconds = 0.5 * turn.balancer.unit_seconds();
    NodeId victim;
    double latest = 0.0;
    for (const auto& [holder, claim] : plan_.claims()) {
        const NodeCapacity* capacity = turn.find(holder);
        if (holder == node.node || capacity == nullptr) continue;
        if (forecast(turn).is_late(holder)) {
            plan_.release_claim(holder);
            return true;
        }
        const auto left = static_cast<double>(plan_.pixel_samples(claim));
        const double duration = left / (turn.balancer.assumed_rate(holder) * capacity->workers);
        const double mine = 0.5 * left / (turn.balancer.assumed_rate(node.node) * node.workers);
        if (duration < min_seconds || mine > duration || duration <= latest) continue;
        latest = duration;
        victim = holder;
    }
    if (latest == 0.0) return false;
    plan_.take_over(node.node, victim);
    return true;
}

// Nodes that may not take units any more: they have left, or hold another version of the scene.
void Scheduler::release_claims_of_others(std::span<const NodeCapacity> nodes) {
    std::vector<NodeId> released;
    for (const auto& [holder, claim] : plan_.claims()) {
        if (std::none_of(nodes.begin(), nodes.end(),
                         [holder = holder](const NodeCapacity& node) { return node.node == holder; }))
            released.push_back(holder);
    }
    for (const NodeId node : released) plan_.release_claim(node);
}

// A unit that is far overdue, if it takes this node as long as all nodes take for what has not been dealt. Otherwise a slow
// node might take it when nothing else is left, and end after all others.
std::optional<Assignment> Scheduler::deal_overdue(const NodeCapacity& node, Turn& turn) {
    const double unit = turn.balancer.unit_seconds(), overdue = 5.0 * unit, left = seconds_left(turn);
    if (left <= 0.0 || left >= 10.0 * unit || ledger_.open().empty()) return std::nullopt;
    // Forecasts take time, and even the oldest unit is rarely so old.
    const auto& oldest = ledger_.open().begin()->second.holders;
    if (std::ranges::none_of(oldest,
                             [&](const auto& one) { return seconds(turn.now - one.second) >= overdue; }))
        return std::nullopt;
    return duplicate(node, turn, [&](const Forecast::Awaited& awaited, double mine) {
        return awaited.all_are_late && awaited.done >= overdue && left <= mine && mine <= left + unit;
    });
}

// The unit whose film will arrive last, if this node's would arrive sooner. It splits the film of its claim in three: that
// has to gain some time. `may_be`: of a unit, and the seconds until this node's film of it would arrive.
std::optional<Assignment> Scheduler::duplicate(
    const NodeCapacity& node, Turn& turn,
    const std::function<bool(const Forecast::Awaited&, double)>& may_be) {
    const double gain = 0.5 * turn.balancer.unit_seconds();
    const std::vector<Forecast::Awaited>& awaited = forecast(turn).awaited();
    std::optional<std::size_t> best;
    double latest = 0.0;
    for (std::size_t i = 0; i < awaited.size(); ++i) {
        const auto& [unit, done, all_are_late, all_are_slow] = awaited[i];
        if (done < latest || (unit->holders.size() > 1 && !all_are_late)) continue;
        if (unit->holders.contains(node.node) || (unit->trouble && unit->trouble->has_failed_on(node.node)))
            continue;
        // Samples that may have cost a node go to one node at a time, see DoubtfulTiles, unless that has become slow: it may
        // have died of them as well, which is noticed with the next heartbeat.
        const std::size_t lives = ledger_.lives(unit->trouble);
        if (lives > 1 || (lives == 1 && !all_are_slow)) continue;
        const std::uint64_t samples = unit->unit.pixel_samples();
        const double mine = Forecast::expected_seconds(turn.balancer, node, samples);
        if (done <= mine + gain || !may_be(awaited[i], mine)) continue;
        best = i;
        latest = done;
    }
    if (!best) return std::nullopt;
    ++reissued_;
    const view::WorkUnit unit = awaited[*best].unit->unit;
    ledger_.deal_again(unit.id, node.node, turn.now);
    turn.forecast->dealt_again(*best);
    return Assignment{node.node, unit};
}

void Scheduler::cut_round_for_deadline(const Turn& turn) {
    if (!deadline_ || !plan_.at_round_start() || turn.rate <= 0.0) return;
    const double needed = static_cast<double>(plan_.round_samples()) / turn.rate;
    // In seconds: with the rate that a node claims it may be centuries.
    if (needed > seconds(*deadline_ - turn.now)) plan_.deal_round_in_eighths();
}

void Scheduler::begin_step(std::vector<Round> rounds) {
    if (rounds.empty()) return plan_.finish_steps();
    ledger_.begin_step();
    plan_.begin_step(std::move(rounds));
}

// ---- ends ----

Admission Scheduler::admit(NodeId node, const ArrivingFilm& film) {
    Admission admission = ledger_.admit(node, film);
    if (!admission.problem.empty() || admission.use == Admission::Use::Drop) return admission;
    if (sealed_ && !ledger_.samples(admission.tile).covers(film.block)) {
        admission.use = Admission::Use::Drop;
    } else {
        ++merging_;
    }
    return admission;
}

bool Scheduler::end(UnitId unit, NodeId node, Fate fate) {
    const bool held = ledger_.end(unit, node, fate);
    collect_returned();
    return held;
}

void Scheduler::end_film(NodeId node, std::uint32_t tile, const SampleBlock& block, Fate fate) {
    ledger_.end_film(node, tile, block, fate);
    collect_returned();
}

bool Scheduler::failed(UnitId unit, NodeId node, UnitTrouble::Kind kind, const std::string& message) {
    const bool held = ledger_.fail(unit, node, kind, message);
    collect_returned();
    return held;
}

void Scheduler::node_gone(const UnitLedger::Loss& loss) {
    plan_.release_claim(loss.node);
    ledger_.node_gone(loss);
    collect_returned();
}

void Scheduler::collect_returned() {
    for (UnitLedger::Returned& returned : ledger_.take_returned()) {
        if (closed_) continue;
        if (returned.trouble && ledger_.is_settled(*returned.trouble)) {
            ledger_.blame_samples(returned.trouble);
            // Later samples of the tile would fail on the next nodes, too.
            give_up({returned.tile, returned.block, returned.trouble->message});
        } else {
            plan_.give_back(
                {.tile = returned.tile, .block = returned.block, .trouble = std::move(returned.trouble)});
        }
    }
}

void Scheduler::give_up(const TileFailure& tile) {
    if (plan_.is_closed(tile.tile)) return;
    plan_.close_tile(tile.tile);
    failed_tiles_.push_back(tile);
}

std::uint32_t Scheduler::tiles_without_samples() const {
    const auto failed =
        std::count_if(failed_tiles_.begin(), failed_tiles_.end(),
                      [&](const TileFailure& tile) { return !ledger_.has_samples(tile.tile); });
    return ledger_.tiles_without_samples() - static_cast<std::uint32_t>(failed);
}

std::vector<Cancellation> Scheduler::revise(std::uint64_t revision) {
    std::vector<Cancellation> cancellations = ledger_.end_all();
    collect_returned();
    revision_ = revision;
    return cancellations;
}

std::vector<Cancellation> Scheduler::cancel_everything() {
    closed_ = true;
    return ledger_.holders();
}

session::UnitCounts Scheduler::counts() const {
    session::UnitCounts counts = ledger_.counts();
    counts.issued = issued_;
    counts.reissued = reissued_;
    if (closed_ || complete()) counts.cancelled += ledger_.in_flight();
    return counts;
}

void add(session::UnitCounts& to, const session::UnitCounts& from) {
    to.issued += from.issued;
    to.reissued += from.reissued;
    to.merged += from.merged;
    to.duplicate += from.duplicate;
    to.cancelled += from.cancelled;
    to.refused += from.refused;
    to.lost += from.lost;
}

}  // namespace tessera::master
