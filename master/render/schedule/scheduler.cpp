#include "master/render/schedule/scheduler.h"

#include <algorithm>

namespace tessera::master {

using frame::SampleBlock;

namespace {

std::uint32_t workers_of(std::span<const NodeCapacity> nodes) {
    std::uint32_t workers = 0;
    for (const NodeCapacity& node : nodes) workers += node.workers;
    return workers;
}

}  // namespace

Scheduler::Scheduler(const PlanSettings& plan, ViewId view, std::uint64_t revision, Version version,
                     UnitId first_unit, std::optional<TimePoint> deadline)
    : plan_(plan),
      view_(view),
      revision_(revision),
      version_(version),
      deadline_(deadline),
      ledger_(plan_.tiles(), first_unit) {}

view::WorkUnit Scheduler::make_unit(const Plan::Chunk& chunk) const {
    return {.id = ledger_.next_unit(),
            .view = view_,
            .revision = revision_,
            .version = version_,
            .tile = plan_.tiles()[chunk.tile],
            .block = chunk.block};
}

// ---- dealing ----

std::vector<Assignment> Scheduler::assign(std::span<const NodeCapacity> nodes, const Balancer& balancer,
                                          TimePoint now) {
    std::vector<Assignment> assignments;
    if (closed_) return assignments;
    release_claims_of_others(nodes);
    std::vector<NodeCapacity> capacities(nodes.begin(), nodes.end());
    // One unit per turn, so that one node's prefetch does not empty the plan while another starves.
    for (bool dealt = true; dealt;) {
        dealt = false;
        for (NodeCapacity& node : capacities) {
            if (node.free_slots == 0) continue;
            cut_round_for_deadline(nodes, balancer, now);
            auto assignment = deal(node, nodes, balancer, now);
            if (!assignment && node.in_flight < node.workers)
                assignment = duplicate(node.node, nodes, balancer, now);
            if (!assignment) continue;
            --node.free_slots;
            ++node.in_flight;
            assignments.push_back(std::move(*assignment));
            dealt = true;
        }
    }
    return assignments;
}

std::optional<Assignment> Scheduler::deal(const NodeCapacity& node, std::span<const NodeCapacity> nodes,
                                          const Balancer& balancer, TimePoint now) {
    while (auto chunk = next_chunk(node, nodes, balancer)) {
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
        ledger_.deal(unit, chunk->tile, std::move(chunk->trouble), node.node, now);
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

std::optional<Plan::Chunk> Scheduler::next_chunk(const NodeCapacity& node,
                                                 std::span<const NodeCapacity> nodes,
                                                 const Balancer& balancer) {
    const std::uint32_t workers = workers_of(nodes);
    const std::uint64_t samples = balancer.unit_samples(node.node, plan_.remaining_samples(), workers);
    const std::size_t pixels =
        std::max<std::size_t>(1, plan_.tiles().empty() ? 1 : plan_.tiles()[0].pixel_count());
    const std::uint64_t count = std::max<std::uint64_t>(1, samples / pixels);
    const DoubtfulTiles doubtful(*this, node.node);
    // What failed on a node goes to another one, unless there is none.
    const auto may_go = [&](const Plan::Chunk& chunk) {
        if (!doubtful.may_go(chunk)) return false;
        return !chunk.trouble || !chunk.trouble->has_failed_on(node.node) ||
               std::all_of(nodes.begin(), nodes.end(), [&](const NodeCapacity& other) {
                   return chunk.trouble->has_failed_on(other.node);
               });
    };
    if (auto chunk = plan_.next_returned(count, may_go)) return chunk;
    const auto node_count = static_cast<std::uint32_t>(nodes.size());
    if (auto chunk = plan_.next(node.node, count, node_count, workers)) return chunk;
    if (!take_over_a_claim(node, nodes, balancer)) return std::nullopt;
    return plan_.next(node.node, count, node_count, workers);
}

// No samples are left to claim: an idle node takes a part of the claim that would be finished last, if that is sooner.
bool Scheduler::take_over_a_claim(const NodeCapacity& node, std::span<const NodeCapacity> nodes,
                                  const Balancer& balancer) {
    // Each part costs the network one more film: the last units are not split, but dealt twice if they are late.
    const double min_seconds = 2.0 * balancer.unit_seconds();
    NodeId victim;
    double latest = 0.0;
    for (const auto& [holder, claim] : plan_.claims()) {
        const auto capacity = std::find_if(nodes.begin(), nodes.end(), [holder = holder](const auto& other) {
            return other.node == holder;
        });
        if (holder == node.node || capacity == nodes.end()) continue;
        const auto left = static_cast<double>(claim.left() * plan_.tiles()[claim.tile].pixel_count());
        const double duration = left / (balancer.assumed_rate(holder) * capacity->workers);
        const double mine = 0.5 * left / (balancer.assumed_rate(node.node) * node.workers);
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

// When each holder will have rendered its units, in s from now, as far as rates tell: it renders them in the order in
// which it got them, and sends the film of consecutive ones together after the last.
class Scheduler::Forecast {
  public:
    static constexpr double Never = 1e9;

    Forecast(const UnitLedger& ledger, std::span<const NodeCapacity> nodes, const Balancer& balancer,
             TimePoint now) {
        std::map<NodeId, std::uint32_t> workers;
        for (const NodeCapacity& node : nodes) workers[node.node] = std::max(1u, node.workers);
        for (const auto& [id, unit] : ledger.open()) {
            for (const auto& [holder, since] : unit.holders) {
                const double expected = expected_seconds(balancer, holder, unit.unit);
                Holder& all = holders_[holder];
                const double start = std::max(all.busy_until, -seconds(now - since));
                all.busy_until = start + expected / std::max(1u, workers[holder]);
                all.last_end = std::max(all.last_end, start + expected);
                all.total += expected;
                ends_[{id, holder}] = start + expected;
            }
        }
    }

    // Overdue work counts as never.
    double end(UnitId unit, NodeId holder) const {
        const Holder& all = holders_.at(holder);
        const bool is_overdue = -all.last_end > 2.0 * all.total + 0.05;
        return is_overdue ? Never : ends_.at({unit, holder});
    }

    static double expected_seconds(const Balancer& balancer, NodeId node, const view::WorkUnit& unit) {
        const double rate = balancer.rate(node);
        const auto samples = static_cast<double>(unit.block.count() * unit.tile.pixel_count());
        return rate > 0.0 ? samples / rate : 0.0;
    }

  private:
    struct Holder {
        double busy_until = -Never, last_end = -Never, total = 0.0;
    };
    std::map<NodeId, Holder> holders_;
    std::map<std::pair<UnitId, NodeId>, double> ends_;
};

std::optional<Assignment> Scheduler::duplicate(NodeId node, std::span<const NodeCapacity> nodes,
                                               const Balancer& balancer, TimePoint now) {
    const Forecast forecast(ledger_, nodes, balancer, now);
    const view::WorkUnit* best = nullptr;
    double latest = 0.0;
    for (const auto& [id, unit] : ledger_.open()) {
        const bool has_failed_here = unit.trouble && unit.trouble->has_failed_on(node);
        if (unit.is_covered || unit.holders.contains(node) || has_failed_here) continue;
        if (ledger_.lives(unit.trouble) > 0) continue;  // one node at a time: see DoubtfulTiles
        double done = Forecast::Never;                  // by the first of its holders
        for (const auto& [holder, since] : unit.holders) done = std::min(done, forecast.end(id, holder));
        if (unit.holders.size() > 1 && done < Forecast::Never) continue;
        // Take the unit that the slowest holder was given last: the least likely to have been started. It splits the
        // film of its claim in three: that has to gain a unit's time.
        const double mine = Forecast::expected_seconds(balancer, node, unit.unit);
        if (done > mine + balancer.unit_seconds() && done >= latest) {
            best = &unit.unit;
            latest = done;
        }
    }
    if (best == nullptr) return std::nullopt;
    ++reissued_;
    const view::WorkUnit unit = *best;
    ledger_.deal_again(unit.id, node, now);
    return Assignment{node, unit};
}

void Scheduler::cut_round_for_deadline(std::span<const NodeCapacity> nodes, const Balancer& balancer,
                                       TimePoint now) {
    if (!deadline_ || !plan_.at_round_start()) return;
    double rate = 0.0;
    for (const NodeCapacity& node : nodes) rate += node.workers * balancer.rate(node.node);
    if (rate <= 0.0) return;
    const double needed = static_cast<double>(plan_.round_samples()) / rate;
    // In seconds: with the rate that a node claims it may be centuries.
    if (needed > seconds(*deadline_ - now)) plan_.deal_round_in_eighths();
}

// ---- ends ----

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
    const auto failed = std::count_if(
        failed_tiles_.begin(), failed_tiles_.end(),
        [&](const TileFailure& tile) { return ledger_.samples(tile.tile).sample_count() == 0; });
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
