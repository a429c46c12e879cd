// Nodes: which of them may render a pass, and what they are given.
#include <algorithm>
#include <utility>

#include "master/peers/suitable_nodes.h"
#include "master/render/dispatcher.h"
#include "master/render/schedule/stuck_allowance.h"

namespace tessera::master {

namespace {

std::string samples_text(const view::WorkUnit& unit) {
    const Rect& tile = unit.tile;
    return "unit " + std::to_string(unit.id.value) + " (" + std::to_string(tile.width) + "x" +
           std::to_string(tile.height) + " pixels at " + std::to_string(tile.x) + "," +
           std::to_string(tile.y) + ", samples " + std::to_string(unit.block.first) + ".." +
           std::to_string(unit.block.first + unit.block.count() - 1) + ")";
}

}  // namespace

bool Dispatcher::suits(const NodeRecord& node, const view::View& view,
                       const NodeRequirements& requirements) const {
    return master::suits(node, view, requirements.version) && (!node.is_null || may_use_null_nodes(view)) &&
           (!requirements.reproducible ||
            (node.hello.reproducible && (requirements.kind.empty() || requirements.kind == node.hello.kind)));
}

// Test patterns are never mixed with film of the scene.
bool Dispatcher::may_use_null_nodes(const view::View& view) const {
    if (!nodes_.all_are_null()) return false;
    const auto pass = passes_.find(view.id);
    return pass == passes_.end() || !pass->second.has_other_film;
}

bool Dispatcher::is_superseded(ViewId pass) const {
    const auto found = passes_.find(pass);
    return found != passes_.end() && found->second.has_null_film && !nodes_.all_are_null();
}

bool Dispatcher::ready(const NodeRecord& node, const view::View& view,
                       const NodeRequirements& requirements) const {
    return suits(node, view, requirements) && master::ready(node, view, requirements.version);
}

std::vector<NodeCapacity> Dispatcher::capacities() const {
    std::vector<NodeCapacity> capacities;
    for (const auto& [id, node] : nodes_.all()) capacities.push_back(node.capacity());
    return capacities;
}

void Dispatcher::deal(ViewId id, std::vector<NodeCapacity>& capacities, TimePoint now) {
    Active* pass = active(id);
    if (pass == nullptr) return;
    NodeRequirements& requirements = pass->requirements;
    if (requirements.reproducible && requirements.kind.empty())
        requirements.kind = leading_kind(pass->view, requirements.version);
    // A node that fails much gets no more until it is known whose fault that is, unless all do.
    constexpr std::uint32_t MaxUnexplained = 3;
    std::vector<NodeCapacity> suitable, suspect;
    for (const NodeCapacity& capacity : capacities) {
        if (!ready(*nodes_.find(capacity.node), pass->view, requirements)) continue;
        const bool fails = unexplained_failures(capacity.node) >= MaxUnexplained;
        (fails ? suspect : suitable).push_back(capacity);
    }
    if (suitable.empty()) suitable = std::move(suspect);
    if (suitable.empty()) return;
    for (const Assignment& assignment : pass->scheduler.assign(suitable, balancer_, now)) {
        NodeRecord& node = *nodes_.find(assignment.node);
        send_work(node, pass->view, pass->hold_film, assignment.unit);
        for (NodeCapacity& capacity : capacities) {
            if (capacity.node != assignment.node) continue;
            capacity.free_slots -= std::min(capacity.free_slots, 1u);  // short units go beyond them
            ++capacity.in_flight;
        }
    }
}

void Dispatcher::send_work(NodeRecord& node, const view::View& view, Duration hold_film,
                           const view::WorkUnit& unit) {
    if (auto opening = node.opening(view, hold_film)) outbox_.control(node.control, *std::move(opening));
    node.pending[unit.id] = ++node.work_sequence;
    outbox_.control(node.control, wire::Work{node.work_sequence, unit});
    trace(unit, node.id, "unit is dealt: " + samples_text(unit));
}

Dispatcher::Prospects Dispatcher::prospects(const view::View& view, const NodeRequirements& wanted) const {
    NodeRequirements requirements = wanted;
    if (wanted.reproducible && wanted.kind.empty()) requirements.kind = leading_kind(view, wanted.version);
    Prospects prospects;
    for (const auto& [id, node] : nodes_.all()) {
        if (!suits(node, view, requirements)) continue;
        ++prospects.suitable;
        prospects.workers += std::max(1u, node.hello.concurrent_units);
        prospects.building += node.state.phase == session::NodePhase::Building ? 1 : 0;
        prospects.scene_bytes += node.state.scene_bytes;
        const double rate = balancer_.rate(id);
        double& slowest = prospects.slowest_worker;
        if (rate > 0.0) slowest = slowest > 0.0 ? std::min(slowest, rate) : rate;
        if (!ready(node, view, requirements)) continue;
        ++prospects.ready;
        prospects.samples_per_second += node.capacity().workers * rate;
    }
    return prospects;
}

// ---- who takes part ----

namespace {

constexpr std::string_view NullNodeIdles =
    "the null back-end renders test patterns, and there are nodes that render the scene";

std::string takes_no_part(const NodeRecord& node, const std::string& reason) {
    return "node " + node.hello.name + " (kind " + node.hello.kind + ") takes no part: " + reason;
}

}  // namespace

std::string Dispatcher::leading_kind(const view::View& view, Version version) const {
    struct Strength {
        double samples_per_second = 0.0;
        std::uint32_t workers = 0;
    };
    std::map<std::string, Strength> kinds;
    bool all_measured = true;
    for (const auto& [id, node] : nodes_.all()) {
        if (!suits(node, view, {version, true})) continue;
        Strength& kind = kinds[node.hello.kind];
        const std::uint32_t workers = node.capacity().workers;
        kind.workers += workers;
        kind.samples_per_second += workers * balancer_.rate(id);
        all_measured = all_measured && balancer_.rate(id) > 0.0;
    }
    const auto most = std::max_element(kinds.begin(), kinds.end(), [&](const auto& a, const auto& b) {
        return all_measured ? a.second.samples_per_second < b.second.samples_per_second
                            : a.second.workers < b.second.workers;
    });
    return most == kinds.end() ? "" : most->first;
}

std::string Dispatcher::kind(ViewId pass) const {
    const auto found = passes_.find(pass);
    return found == passes_.end() ? "" : found->second.requirements.kind;
}

std::string Dispatcher::obstacles(const view::View& view, const NodeRequirements& requirements) const {
    std::string text = master::obstacles(nodes_, view, requirements.version);
    const auto nulls =
        std::ranges::count_if(nodes_.all(), [](const auto& entry) { return entry.second.is_null; });
    if (nulls > 0 && !may_use_null_nodes(view))
        text += std::to_string(nulls) + " null nodes idle, since they render test patterns; ";
    if (!requirements.reproducible) return text;
    if (!requirements.kind.empty())
        return text + "the frame is reproducible on kind " + requirements.kind +
               " alone: start a node of this kind; ";
    const auto count = std::ranges::count_if(
        nodes_.all(), [](const auto& entry) { return !entry.second.hello.reproducible; });
    if (count > 0)
        text += "the frame is reproducible, and " + std::to_string(count) +
                " nodes are not pinned to AVX2: start them with --isa avx2; ";
    std::set<std::string> kinds;
    for (const auto& [id, node] : nodes_.all()) {
        if (suits(node, view, requirements)) kinds.insert(node.hello.kind);
    }
    if (kinds.size() > 1)
        text += "the frame is reproducible, so nodes of one kind alone take part, and there are " +
                std::to_string(kinds.size()) + " kinds; ";
    return text;
}

std::string Dispatcher::why_left_out(const NodeRecord& node, const Active& pass) const {
    if (node.is_null && !may_use_null_nodes(pass.view)) return std::string(NullNodeIdles);
    const NodeRequirements& wanted = pass.requirements;
    if (!wanted.reproducible || wanted.kind.empty() || suits(node, pass.view, wanted) ||
        !master::suits(node, pass.view, wanted.version))
        return {};
    return "the frame is reproducible on kind " + wanted.kind +
           (node.hello.kind == wanted.kind ? ", and this node is not pinned to AVX2 (--isa avx2)" : "");
}

std::string Dispatcher::idle_reason(const NodeRecord& node) const {
    if (node.is_null && !nodes_.all_are_null()) return std::string(NullNodeIdles);
    for (const auto& [view, pass] : passes_) {
        if (std::string reason = why_left_out(node, pass); !reason.empty()) return reason;
    }
    return {};
}

std::vector<std::string> Dispatcher::left_out(ViewId pass) const {
    std::vector<std::string> texts;
    const auto found = passes_.find(pass);
    if (found == passes_.end()) return texts;
    for (const auto& [id, node] : nodes_.all()) {
        if (const std::string reason = why_left_out(node, found->second); !reason.empty())
            texts.push_back(takes_no_part(node, reason));
    }
    return texts;
}

// ---- lost nodes ----

std::string Dispatcher::rendered_by(NodeId id) const {
    constexpr std::size_t MaxNamed = 8;
    const NodeRecord* node = nodes_.find(id);
    if (node == nullptr) return {};
    std::string text;
    for (const auto& [view, pass] : passes_) {
        const std::vector<UnitId> held = pass.scheduler.held_by(id);
        const std::size_t count = std::min<std::size_t>(held.size(), node->capacity().workers);
        for (std::size_t i = 0; i < count && i < MaxNamed; ++i)
            text += (text.empty() ? "; it rendered " : ", ") +
                    samples_text(pass.scheduler.ledger().find(held[i])->unit);
        if (count > MaxNamed) text += " and " + std::to_string(count - MaxNamed) + " more";
    }
    return text;
}

void Dispatcher::node_gone(NodeId id, Departure departure, TimePoint now) {
    balancer_.forget(id);
    verifier_.node_gone(id);
    cancelled_.clear();  // some will never be confirmed
    const NodeRecord* node = nodes_.find(id);
    const std::uint32_t rendering =
        departure != Departure::Expected && node != nullptr ? node->capacity().workers : 0;
    for (auto& [view, pass] : passes_) {
        lose(pass, {.node = id,
                    .rendering = rendering,
                    .has_ended = departure == Departure::Ended,
                    .now = now,
                    .describe = {}});
        take_explained(pass.scheduler, now);
    }
}

void Dispatcher::lose(Active& pass, UnitLedger::Loss loss) {
    const NodeRecord* node = nodes_.find(loss.node);
    loss.describe = [&](const view::WorkUnit& unit) {
        return samples_text(unit) + " failed: node " + (node == nullptr ? "" : node->hello.name) +
               " and others " + (loss.has_ended ? "ended" : "vanished") +
               " while they rendered it; replay it with: tessera probe SCENE --pixel " +
               std::to_string(unit.tile.x) + "," + std::to_string(unit.tile.y) + " --sample " +
               std::to_string(unit.block.first) + " --seed " + std::to_string(pass.view.seed);
    };
    const std::size_t before = pass.scheduler.failed_tiles().size();
    pass.scheduler.node_gone(loss);
    const auto& failed = pass.scheduler.failed_tiles();
    for (std::size_t i = before; i < failed.size(); ++i)
        events_({wire::Severity::Error, "a tile is left out: " + failed[i].message, {.view = pass.view.id}});
}

void Dispatcher::came_back(NodeId former) {
    for (auto& [view, pass] : passes_) pass.scheduler.came_back(former);
}

// ---- stuck nodes ----

// What its units may take until one of them is finished.
Duration Dispatcher::allowance(NodeId node) const {
    const StuckSettings& settings = nodes_.stuck();
    const double rate = balancer_.rate(node);
    const auto predicted = [&](const Rect& tile, const frame::SampleBlock& block) {
        return stuck_allowance(settings, rate, block.count() * tile.pixel_count());
    };
    Duration longest{};
    for (const auto& [view, pass] : passes_) {
        const bool may_compile = !pass.rendered_by.contains(node);
        for (const UnitId id : pass.scheduler.held_by(node)) {
            if (may_compile) {
                longest = std::max(longest, settings.first_film);
                break;
            }
            const view::WorkUnit& unit = pass.scheduler.ledger().find(id)->unit;
            longest = std::max(longest, predicted(unit.tile, unit.block));
        }
    }
    for (const auto& [unit, task] : verifier_.tasks_of(node))
        longest = std::max(longest, predicted(task->tile, task->block));
    return longest;
}

void Dispatcher::announce_stuck(NodeRecord& node, TimePoint now) {
    if (std::exchange(node.stuck_is_announced, true)) return;
    events_(
        {wire::Severity::Warning,
         "node " + node.hello.name + " is stuck: it has finished nothing for " +
             std::to_string(std::chrono::round<std::chrono::seconds>(now - node.last_progress_at).count()) +
             " s; others get its units",
         {.node = node.hello.name}});
}

void Dispatcher::announce_idle(NodeRecord& node) {
    constexpr std::size_t MaxAnnounced = 64;
    const std::string reason = idle_reason(node);
    if (reason.empty() || node.announced.size() >= MaxAnnounced || !node.announced.insert(reason).second)
        return;
    events_({wire::Severity::Info, takes_no_part(node, reason), {.node = node.hello.name}});
}

}  // namespace tessera::master
