// Film that is rendered again by other nodes, and what the comparison says.
#include <algorithm>

#include "master/render/dispatcher.h"

namespace tessera::master {

namespace {

std::string names_of(const std::vector<Verifier::Witness>& witnesses) {
    std::string names;
    for (const Verifier::Witness& witness : witnesses)
        names += (names.empty() ? "" : ", ") + witness.identity.second;
    return names;
}

// "unit 7, tile 32,0 of 32 x 32 pixels, samples 0..16"
std::string samples_of(const Verifier::Task& task) {
    const auto text = [](auto number) { return std::to_string(number); };
    return "unit " + text(task.verified.value) + ", tile " + text(task.tile.x) + "," + text(task.tile.y) +
           " of " + text(task.tile.width) + " x " + text(task.tile.height) + " pixels, samples " +
           text(task.block.first) + ".." + text(task.block.end());
}

}  // namespace

// Whether film of the node that arrives now is to be verified: another node could do it.
bool Dispatcher::is_to_be_verified(const NodeRecord& node, const Active& pass) {
    return verifier_.chooses_next() && std::ranges::any_of(nodes_.all(), [&](const auto& entry) {
               const NodeRecord& other = entry.second;
               return other.id != node.id && other.hello.kind == node.hello.kind &&
                      suits(other, pass.view, pass.requirements);
           });
}

void Dispatcher::verify(Active& pass, const MergeReport& report, const NodeRecord& node, TimePoint now) {
    if (!pass.verification) {
        view::View view = pass.view;
        view.id = Verifier::view_of(pass.view.id);
        pass.verification = std::make_shared<const view::View>(std::move(view));
    }
    verifier_.add({.view = pass.verification,
                   .version = pass.requirements.version,
                   .kind = node.hello.kind,
                   .tile = pass.scheduler.tiles().at(report.result.tile),
                   .block = report.block,
                   .verified = report.unit,
                   .units = std::max(1u, report.units),
                   .since = now},
                  {node.id, node.identity(), *report.bits});
}

void Dispatcher::deal_verifications(std::vector<NodeCapacity>& capacities, TimePoint now) {
    if (!verifier_.is_on()) return;
    verifier_.drop_old(now);
    for (NodeCapacity& capacity : capacities) {
        NodeRecord& node = *nodes_.find(capacity.node);
        while (capacity.free_slots > 0 && verifier_.held_by(node.id).size() < capacity.workers) {
            const auto dealt = verifier_.deal(node.id, [&](const Verifier::Task& task) {
                return node.hello.kind == task.kind && ready(node, *task.view, {task.version});
            });
            if (!dealt) break;
            send_work(node, *dealt->view, Duration::zero(), dealt->unit);
            --capacity.free_slots;
            ++capacity.in_flight;
        }
    }
}

std::optional<Admission> Dispatcher::admit_verification(NodeRecord& node, const wire::FilmHead& head,
                                                        std::size_t bytes, TimePoint now) {
    if (!verifier_.was_dealt(head.unit)) {
        malformed_film(node, "film of a unit that was not dealt to it", bytes, now);
        return std::nullopt;
    }
    const Verifier::Task* task = verifier_.held(head.unit, node.id);
    const bool is_whole = task != nullptr && !node.quarantined && head.rect == task->tile &&
                          head.block == task->block && head.version == task->version;
    if (is_whole) return Admission{.problem = {}, .replaceable = {}, .use = Admission::Use::Compare};
    verifier_.end(head.unit, node.id);  // a part of it, because it was stopped
    film_is_taken(node.id, bytes);
    return std::nullopt;
}

void Dispatcher::take_verification(const MergeReport& report, TimePoint now) {
    NodeRecord* node = nodes_.find(report.node);
    if (node == nullptr || !report.bits) {
        verifier_.end(report.unit, report.node);
        ++refused_film_;
        if (node != nullptr) fault(*node, "it sent damaged film: " + report.problem, now);
        return;
    }
    const auto finding = verifier_.take(report.unit, {node->id, node->identity(), *report.bits});
    if (!finding) return;
    const std::vector<Verifier::Witness>& witnesses = finding->task.witnesses;
    const std::string samples = samples_of(finding->task);
    switch (finding->outcome) {
        case Verifier::Outcome::Agreed:
            verified_units_ += finding->task.units;
            return;
        case Verifier::Outcome::Differs: {
            ++contradictions_;
            const bool is_known = std::ranges::any_of(witnesses, [&](const Verifier::Witness& witness) {
                return quarantine_.find(witness.identity, now) != nullptr;
            });
            if (is_known) return;
            events_({wire::Severity::Error,
                     "nodes " + names_of(witnesses) + " gave different bits for " + samples +
                         "; a third node of their kind decides, if there is one; replay: tessera probe SCENE "
                         "--pixel " +
                         std::to_string(finding->task.tile.x) + "," + std::to_string(finding->task.tile.y) +
                         " --sample " + std::to_string(finding->task.block.first)});
            return;
        }
        case Verifier::Outcome::OneIsOdd:
            return condemn(*finding->odd, samples, now);
        case Verifier::Outcome::AllDiffer:
            events_({wire::Severity::Error,
                     "nodes " + names_of(witnesses) + " gave three different results for " + samples});
            return;
    }
}

// The node gave other bits than two others.
void Dispatcher::condemn(const Verifier::Witness& odd, const std::string& samples, TimePoint now) {
    if (quarantine_.find(odd.identity, now) != nullptr) return;
    const std::string reason = "its film differs from that of two other nodes (" + samples + ")";
    quarantine_.begin(odd.identity, reason, now);
    events_({wire::Severity::Error, "node " + odd.identity.second + ": " + reason +
                                        "; pictures with its earlier film may be wrong"});
    for (auto& [id, node] : nodes_.all()) {
        if (node.identity() == odd.identity) start_quarantine(node, reason, now);
    }
}

void Dispatcher::close_verified_views(NodeRecord& node) {
    if (!verifier_.is_on()) return;
    std::erase_if(node.views, [&](const auto& entry) {
        const ViewId view = entry.first;
        if (!Verifier::is_verification(view) || passes_.contains(Verifier::pass_of(view)) ||
            verifier_.uses(view))
            return false;
        outbox_.control(node.control, wire::CloseView{view});
        return true;
    });
}

}  // namespace tessera::master
