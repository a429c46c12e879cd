// Film of nodes: what is admitted, what its merging says, and nodes in quarantine.
#include <algorithm>

#include "master/render/dispatcher.h"

namespace tessera::master {

std::optional<Admission> Dispatcher::admit(NodeRecord& node, const wire::FilmHead& head, std::size_t bytes,
                                           TimePoint now) {
    if (Verifier::is_verification(head.view)) return admit_verification(node, head, bytes, now);
    Active* pass = active(head.view);
    const bool is_stale = pass == nullptr || pass->view.revision != head.revision;
    if (is_stale || node.quarantined) {
        film_is_taken(node.id, bytes);
        return std::nullopt;
    }
    if (holder(head.unit) != pass) {
        malformed_film(node, "film of a unit of another view", bytes, now);
        return std::nullopt;
    }
    Admission admission =
        pass->scheduler.admit(node.id, {head.unit, head.version, head.rect, head.block, head.mask});
    if (admission.use == Admission::Use::Drop) {
        film_is_taken(node.id, bytes);
        return std::nullopt;
    }
    if (admission.problem.empty()) {
        if (is_to_be_verified(node, *pass)) admission.use = Admission::Use::MergeAndHash;
        return admission;
    }
    malformed_film(node, admission.problem, bytes, now);
    return std::nullopt;
}

void Dispatcher::malformed_film(NodeRecord& node, const std::string& problem, std::size_t bytes,
                                TimePoint now) {
    ++refused_film_;
    film_is_taken(node.id, bytes);
    fault(node, "it sent " + problem, now);
}

Dispatcher::Taken Dispatcher::take(const MergeReport& report, TimePoint now) {
    film_is_taken(report.node, report.bytes);
    confirm_cancelled(report.unit, now);  // it was finished already
    Active* origin = holder(report.unit);
    if (origin != nullptr) origin->scheduler.merge_ended();
    if (!report.failure.empty()) {
        events_({wire::Severity::Error, "film was lost, and is rendered again: " + report.failure});
        verifier_.end(report.unit, report.node);
        if (origin != nullptr) origin->scheduler.end_film(report.node, report.tile, report.block, Fate::Lost);
        return Taken::Dropped;
    }
    if (Verifier::is_verification(report.view)) {
        take_verification(report, now);
        return Taken::Dropped;
    }
    Active* pass = report.stale ? nullptr : active(report.view);
    if (pass == nullptr || pass->view.revision != report.revision) return Taken::Dropped;
    Scheduler& scheduler = pass->scheduler;
    NodeRecord* node = nodes_.find(report.node);
    const bool is_misfit = report.result.outcome == FrameAssembler::Outcome::Misfit;
    if (!report.problem.empty() || is_misfit) {
        ++refused_film_;
        scheduler.end_film(report.node, report.tile, report.block, Fate::Refused);
        const std::string problem = is_misfit && report.problem.empty()
                                        ? "film with other channels, or more samples, than its view"
                                        : report.problem;
        if (node != nullptr) fault(*node, "it sent damaged film: " + problem, now);
        return Taken::Dropped;
    }
    pass->rendered_by.insert(report.node);
    Taken taken = Taken::Known;
    switch (report.result.outcome) {
        case FrameAssembler::Outcome::Overlap:
            scheduler.end_film(report.node, report.tile, report.block, Fate::Duplicate);
            return Taken::Dropped;
        case FrameAssembler::Outcome::Conflict:
            if (node != nullptr) report_contradiction(*pass, report, *node);
            break;
        case FrameAssembler::Outcome::Merged:
            taken = Taken::New;
            if (node != nullptr) {
                pass->kinds.insert(node->hello.kind);
                if (report.bits) verify(*pass, report, *node, now);
                (node->is_null ? pass->has_null_film : pass->has_other_film) = true;
            }
            break;
        case FrameAssembler::Outcome::Duplicate:
        case FrameAssembler::Outcome::Misfit:
            break;
    }
    if (report.units > 0) balancer_.measured(report.node, report.pixel_samples, report.busy);
    send_cancellations(scheduler.merged(report.node, report.result.tile, report.block));
    take_explained(scheduler, now);
    return taken;
}

std::optional<session::NodeSummary> Dispatcher::sender(const MergeReport& report) const {
    const NodeRecord* node = nodes_.find(report.node);
    if (node == nullptr) return std::nullopt;
    return session::NodeSummary{.id = node->id,
                                .name = node->hello.name,
                                .host = node->hello.host,
                                .backend = node->hello.backend,
                                .kind = node->hello.kind,
                                .pid = node->hello.pid};
}

// Nodes of different kinds may differ in the last bits.
void Dispatcher::report_contradiction(const Active& pass, const MergeReport& report, const NodeRecord& node) {
    if (pass.kinds != std::set<std::string>{node.hello.kind}) return;
    ++contradictions_;
    const Rect& tile = pass.scheduler.tiles().at(report.result.tile);
    events_({wire::Severity::Error,
             "two nodes gave different bits for samples " + std::to_string(report.block.first) + ".." +
                 std::to_string(report.block.end()) + " (second: " + node.hello.name +
                 "); replay: tessera probe SCENE --pixel " + std::to_string(tile.x) + "," +
                 std::to_string(tile.y) + " --sample " + std::to_string(report.block.first),
             {.node = node.hello.name, .view = report.view, .unit = report.unit}});
}

// ---- acknowledgements ----

void Dispatcher::film_is_taken(NodeId id, std::uint64_t bytes) {
    NodeRecord* node = nodes_.find(id);
    if (node == nullptr) return;
    node->film_taken += bytes;
    node->film_taken_is_new = true;
}

void Dispatcher::send_film_taken() {
    for (auto& [id, node] : nodes_.all()) {
        if (!std::exchange(node.film_taken_is_new, false)) continue;
        outbox_.control(node.control, wire::FilmTaken{node.film_taken});
    }
}

// ---- quarantine ----

std::uint32_t Dispatcher::unexplained_failures(NodeId node) const {
    std::uint32_t failures = 0;
    for (const auto& [view, pass] : passes_) failures += pass.scheduler.ledger().unexplained_failures(node);
    return failures;
}

void Dispatcher::take_explained(Scheduler& scheduler, TimePoint now) {
    for (const UnitLedger::Explained& failure : scheduler.take_explained()) {
        NodeRecord* node = nodes_.find(failure.node);
        if (node != nullptr && failure.is_to_blame)
            fault(*node, "it failed what another node rendered: " + failure.message, now);
    }
}

void Dispatcher::fault(NodeRecord& node, const std::string& reason, TimePoint now) {
    events_({wire::Severity::Warning, "node " + node.hello.name + ": " + reason, {.node = node.hello.name}});
    if (quarantine_.fault(node.identity(), reason, now)) start_quarantine(node, reason, now);
}

void Dispatcher::start_quarantine(NodeRecord& node, const std::string& reason, TimePoint now) {
    node.quarantined = true;
    const Duration time = *quarantine_.find(node.identity(), now)->until - now;
    events_({wire::Severity::Error,
             "node " + node.hello.name + " gets no work for " +
                 std::to_string(std::chrono::ceil<std::chrono::seconds>(time).count()) + " s: " + reason +
                 "; mend it, then: tessera node release " + node.hello.name,
             {.node = node.hello.name}});
    take_units_back(node, Fate::Refused);
}

void Dispatcher::take_units_back(const NodeRecord& node, Fate fate) {
    std::vector<Cancellation> cancellations;
    for (const UnitId unit : verifier_.held_by(node.id)) cancellations.push_back({node.id, unit});
    verifier_.node_gone(node.id);
    for (auto& [view, pass] : passes_) {
        for (const UnitId unit : pass.scheduler.held_by(node.id)) {
            pass.scheduler.end(unit, node.id, fate);
            cancellations.push_back({node.id, unit});
        }
    }
    send_cancellations(cancellations);
}

void Dispatcher::joined(NodeRecord& node, TimePoint now) {
    node.quarantined = quarantine_.find(node.identity(), now) != nullptr;
}

bool Dispatcher::release_from_quarantine(const std::string& name, TimePoint now) {
    if (!quarantine_.release(name, now)) return false;
    for (auto& [id, node] : nodes_.all()) {
        if (node.hello.name == name) node.quarantined = quarantine_.find(node.identity(), now) != nullptr;
    }
    return true;
}

}  // namespace tessera::master
