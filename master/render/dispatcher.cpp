#include "master/render/dispatcher.h"

#include <algorithm>

namespace tessera::master {

namespace {
constexpr std::uint64_t UnitsPerPass = std::uint64_t{1} << 32;
}

Dispatcher::Dispatcher(Duration overdue_patience, const Clock& clock, NodeTable& nodes, Outbox& outbox,
                       EventSink events, const VerifierSettings& verifier)
    : overdue_patience_(overdue_patience),
      clock_(clock),
      nodes_(nodes),
      outbox_(outbox),
      events_(std::move(events)),
      verifier_(verifier) {}

// ---- passes ----

Scheduler& Dispatcher::begin(const view::View& view, const PlanSettings& plan,
                             const NodeRequirements& requirements, std::optional<TimePoint> deadline) {
    if (Active* before = active(view.id)) {
        send_cancellations(before->scheduler.cancel_everything());
        add(counts_, before->scheduler.counts());
        by_first_unit_.erase(before->first_unit);
        passes_.erase(view.id);
    }
    send_cancellations(verifier_.forget(Verifier::view_of(view.id)));
    const UnitId first{next_unit_};
    next_unit_ += UnitsPerPass;
    by_first_unit_[first] = view.id;
    const auto it = passes_.emplace(
        view.id, Active{view, requirements, plan.hold_film, first,
                        Scheduler(plan, view.id, view.revision, requirements.version, first, deadline)});
    Scheduler& scheduler = it.first->second.scheduler;
    scheduler.observe_ends([this](const view::WorkUnit& unit, NodeId node, Fate fate) {
        trace(unit, node, "unit ends: " + std::string(enumerator_name(fate)));
    });
    return scheduler;
}

void Dispatcher::end(ViewId pass) {
    Active* ended = active(pass);
    if (ended == nullptr) return;
    send_cancellations(ended->scheduler.cancel_everything());
    add(counts_, ended->scheduler.counts());
    by_first_unit_.erase(ended->first_unit);
    passes_.erase(pass);
    for (auto& [id, node] : nodes_.all()) {
        if (node.views.erase(pass) > 0) outbox_.control(node.control, wire::CloseView{pass});
    }
}

void Dispatcher::cancel(ViewId pass) {
    if (Active* cancelled = active(pass)) send_cancellations(cancelled->scheduler.cancel_everything());
}

void Dispatcher::seal(ViewId pass) {
    if (Active* sealed = active(pass)) sealed->scheduler.seal();
}

void Dispatcher::revise(const view::View& view) {
    Active* pass = active(view.id);
    if (pass == nullptr) return;
    pass->view = view;
    pass->verification.reset();
    send_cancellations(verifier_.forget(Verifier::view_of(view.id)));
    pass->rendered_by.clear();  // other channels are other kernels
    send_cancellations(pass->scheduler.revise(view.revision));
}

void Dispatcher::follow(ViewId pass, Version version) {
    if (Active* followed = active(pass)) {
        followed->requirements.version = version;
        followed->scheduler.follow(version);
        verifier_.follow(Verifier::view_of(pass), version);
    }
}

Scheduler* Dispatcher::find(ViewId pass) {
    Active* found = active(pass);
    return found == nullptr ? nullptr : &found->scheduler;
}

const Scheduler* Dispatcher::find(ViewId pass) const {
    const auto found = passes_.find(pass);
    return found == passes_.end() ? nullptr : &found->second.scheduler;
}

Dispatcher::Active* Dispatcher::active(ViewId pass) {
    const auto found = passes_.find(pass);
    return found == passes_.end() ? nullptr : &found->second;
}

Dispatcher::Active* Dispatcher::holder(UnitId unit) {
    const auto after = by_first_unit_.upper_bound(unit);
    if (after == by_first_unit_.begin()) return nullptr;
    const auto& [first, pass] = *std::prev(after);
    return unit.value - first.value < UnitsPerPass ? active(pass) : nullptr;
}

void Dispatcher::trace(const view::WorkUnit& unit, NodeId id, std::string text) const {
    const NodeRecord* node = nodes_.find(id);
    LogSubject about{.node = node == nullptr ? "" : node->hello.name, .view = unit.view, .unit = unit.id};
    if (unit.version.number != 0) about.version = unit.version;
    events_({.text = std::move(text), .about = std::move(about), .is_detail = true});
}

// ---- messages ----

void Dispatcher::send_cancellations(const std::vector<Cancellation>& cancellations) {
    constexpr std::size_t PerMessage = 1024, MaxUnconfirmed = 4096;
    std::map<NodeId, std::vector<UnitId>> by_node;
    for (const Cancellation& cancellation : cancellations) {
        by_node[cancellation.node].push_back(cancellation.unit);
        if (cancelled_.size() < MaxUnconfirmed) cancelled_.emplace(cancellation.unit, clock_.now());
        trace({.id = cancellation.unit}, cancellation.node, "unit is cancelled");
    }
    for (const auto& [id, units] : by_node) {
        const NodeRecord* node = nodes_.find(id);
        for (std::size_t i = 0; node != nullptr && i < units.size(); i += PerMessage) {
            const auto begin = units.begin() + static_cast<std::ptrdiff_t>(i);
            const auto end =
                units.begin() + static_cast<std::ptrdiff_t>(std::min(units.size(), i + PerMessage));
            outbox_.control(node->control, wire::CancelUnits{{begin, end}});
        }
    }
}

void Dispatcher::confirm_cancelled(UnitId unit, TimePoint now) {
    if (const auto order = cancelled_.extract(unit)) cancellations_.add(now - order.mapped());
}

// ---- events ----

void Dispatcher::collect_overdue(TimePoint now) {
    for (auto& [id, node] : nodes_.all()) {
        if (node.quarantined && quarantine_.find(node.identity(), now) == nullptr) {
            node.quarantined = false;
            events_({wire::Severity::Info,
                     "node " + node.hello.name + " leaves quarantine",
                     {.node = node.hello.name}});
        }
        announce_idle(node);
        close_verified_views(node);
        std::vector<UnitId> held = verifier_.held_by(id);
        if (passes_.empty() && held.empty()) continue;
        for (const auto& [view, pass] : passes_) {
            const auto units = pass.scheduler.held_by(id);
            held.insert(held.end(), units.begin(), units.end());
        }
        for (const UnitId unit : NodeTable::overdue(node, held, now, overdue_patience_)) {
            verifier_.end(unit, id);
            if (Active* pass = holder(unit)) pass->scheduler.end(unit, id, Fate::Lost);
        }
        node.allowance = allowance(id);
        if (!node.stuck) continue;
        announce_stuck(node, now);
        verifier_.node_gone(id);
        for (auto& [view, pass] : passes_)
            lose(pass, {.node = id, .rendering = node.capacity().workers, .now = now, .describe = {}});
    }
}

void Dispatcher::released(NodeRecord& node, const wire::UnitReleased& release, TimePoint now) {
    node.pending.erase(release.unit);
    confirm_cancelled(release.unit, now);
    if (Verifier::owns(release.unit)) {
        if (release.reason == wire::ReleaseReason::UnknownView) {
            if (const auto* task = verifier_.held(release.unit, node.id)) node.views.erase(task->view->id);
        }
        if (verifier_.end(release.unit, node.id) && release.reason == wire::ReleaseReason::Failed)
            fault(node, "it failed what another node rendered: " + release.message, now);
        return;
    }
    Active* pass = holder(release.unit);
    if (pass == nullptr) return;
    switch (release.reason) {
        case wire::ReleaseReason::Cancelled:
        case wire::ReleaseReason::Leaving:
            pass->scheduler.end(release.unit, node.id, Fate::Cancelled);
            return;
        case wire::ReleaseReason::UnknownView:
            node.views.erase(pass->view.id);  // the message was lost: send it again
            [[fallthrough]];
        case wire::ReleaseReason::OtherVersion:
            pass->scheduler.end(release.unit, node.id, Fate::Refused);
            return;
        case wire::ReleaseReason::Failed:
            break;
    }
    if (!pass->scheduler.failed(release.unit, node.id, UnitTrouble::Kind::Failed, release.message))
        return;  // of a unit that it does not hold: it says nothing
    events_({wire::Severity::Error,
             "node " + node.hello.name + ": " + release.message,
             {.node = node.hello.name, .view = pass->view.id, .unit = release.unit}});
    take_explained(pass->scheduler, now);
}

// Its film may still be in flight on the bulk link; the overdue check catches it if it never arrives.
void Dispatcher::goodbye(NodeRecord& node, const wire::Goodbye& goodbye) {
    const auto& sent = goodbye.units_sent;
    for (const UnitId unit : verifier_.held_by(node.id)) {
        if (std::find(sent.begin(), sent.end(), unit) == sent.end()) verifier_.end(unit, node.id);
    }
    for (auto& [view, pass] : passes_) {
        for (const UnitId unit : pass.scheduler.held_by(node.id)) {
            if (std::find(sent.begin(), sent.end(), unit) != sent.end()) continue;
            pass.scheduler.end(unit, node.id, Fate::Cancelled);
        }
    }
}

session::UnitCounts Dispatcher::counts() const {
    session::UnitCounts counts = counts_;
    for (const auto& [view, pass] : passes_) add(counts, pass.scheduler.counts());
    return counts;
}

}  // namespace tessera::master
