// What goes to nodes and comes back: units, film, what became of them.
#include <algorithm>
#include <cmath>

#include "master/peers/suitable_nodes.h"
#include "master/render/live_runner.h"

namespace tessera::master {

void LiveRunner::deal(LivePass& pass, Version version, std::vector<NodeCapacity>& capacities, TimePoint now) {
    std::vector<NodeCapacity> suitable;
    for (const NodeCapacity& capacity : capacities) {
        if (ready(*nodes_.find(capacity.node), pass.view, version)) suitable.push_back(capacity);
    }
    if (suitable.empty()) return;
    for (const Assignment& assignment : pass.scheduler->assign(suitable, balancer_, now)) {
        NodeRecord& node = *nodes_.find(assignment.node);
        if (auto opening = node.opening(pass.view)) outbox_.control(node.control, *std::move(opening));
        node.pending[assignment.unit.id] = ++node.work_sequence;
        outbox_.control(node.control, wire::Work{node.work_sequence, assignment.unit});
        for (NodeCapacity& capacity : capacities) {
            if (capacity.node != assignment.node) continue;
            --capacity.free_places;
            ++capacity.in_hand;
        }
    }
}

void LiveRunner::deal(TimePoint now) {
    std::vector<NodeCapacity> capacities;
    for (const auto& [id, node] : nodes_.all()) capacities.push_back(node.capacity());
    for (PickTask& task : picks_) {
        if (task.pass.scheduler) deal(task.pass, task.version, capacities, now);
    }
    std::vector<LiveView*> order;
    if (group_ && group_->restart_wanted && !passes_held_ && !group_is_protected()) restart_group();
    for (auto& [id, live] : views_) {
        if (!live.in_group && live.restart_wanted && !passes_held_ && !live.is_protected() &&
            live.problem.empty())
            restart(live);
        if (!live.passes.empty() && live.pass().scheduler) order.push_back(&live);
    }
    if (order.empty()) return;
    // Those without a picture first, then those with the fewest samples; equals take turns.
    std::rotate(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(turn_++ % order.size()),
                order.end());
    std::stable_sort(order.begin(), order.end(), [](const LiveView* a, const LiveView* b) {
        const auto rank = [](const LiveView& live) {
            const double pixels = static_cast<double>(live.view.window.pixel_count());
            const double spp = live.pass().scale > 1
                                   ? 0.0
                                   : double(live.pass().scheduler->merged_samples()) / pixels / live.priority;
            return std::pair(-static_cast<int>(live.pass().scale), std::floor(spp));
        };
        return rank(*a) < rank(*b);
    });
    for (LiveView* live : order) deal(live->pass(), live->version, capacities, now);
}

void LiveRunner::cancel(const std::vector<Cancellation>& cancellations) {
    std::map<NodeId, std::vector<UnitId>> by_node;
    constexpr std::size_t MaxUnconfirmed = 4096;
    for (const Cancellation& cancellation : cancellations) {
        by_node[cancellation.node].push_back(cancellation.unit);
        if (cancelled_.size() < MaxUnconfirmed) cancelled_.emplace(cancellation.unit, now_);
    }
    for (auto& [id, units] : by_node) {
        if (const NodeRecord* node = nodes_.find(id))
            outbox_.control(node->control, wire::CancelUnits{std::move(units)});
    }
}

void LiveRunner::collect_overdue(TimePoint now) {
    for (auto& [id, node] : nodes_.all()) {
        std::vector<UnitId> held;
        const auto each_pass = [&](const auto& act) {
            for (auto& [view, live] : views_) {
                for (LivePass& pass : live.passes) {
                    if (pass.scheduler) act(pass);
                }
            }
            for (PickTask& task : picks_) {
                if (task.pass.scheduler) act(task.pass);
            }
        };
        each_pass([&](LivePass& pass) {
            const auto units = pass.scheduler->held_by(id);
            held.insert(held.end(), units.begin(), units.end());
        });
        for (const UnitId unit : NodeTable::overdue(node, held, now, settings_.overdue_patience)) {
            if (LivePass* pass = pass_of(unit)) pass->scheduler->released(unit, id, Scheduler::Loss::Lost);
        }
        if (node.stuck) each_pass([&](LivePass& pass) { pass.scheduler->node_gone(id); });
    }
}

void LiveRunner::confirm_cancelled(UnitId unit, TimePoint now) {
    if (const auto order = cancelled_.extract(unit)) cancellations_.add(now - order.mapped());
}

void LiveRunner::released(NodeRecord& node, const wire::UnitReleased& release, TimePoint now) {
    node.pending.erase(release.unit);
    confirm_cancelled(release.unit, now);
    LivePass* pass = pass_of(release.unit);
    if (pass == nullptr) return;
    pass->scheduler->released(release.unit, node.id, Scheduler::Loss::Released);
    switch (release.reason) {
        case wire::ReleaseReason::Cancelled:
        case wire::ReleaseReason::Leaving:
            return;
        case wire::ReleaseReason::UnknownView:
            node.views.erase(pass->view.id);  // the message got lost: say it again
            [[fallthrough]];
        case wire::ReleaseReason::OtherVersion:
            return pass->scheduler->count_refused();
        case wire::ReleaseReason::Failed:
            break;
    }
    pass->scheduler->count_refused();
    events_({wire::Severity::Error, "node " + node.hello.name + ": " + release.message});
    LiveView* live = view_of(pass->view.id);
    if (live != nullptr && ++live->failures >= settings_.failure_limit) fail(*live, release.message);
}

void LiveRunner::goodbye(NodeRecord& node, const wire::Goodbye& goodbye) {
    const auto give_back = [&](LivePass& pass) {
        for (const UnitId unit : pass.scheduler->held_by(node.id)) {
            const auto& sent = goodbye.units_sent;
            if (std::find(sent.begin(), sent.end(), unit) != sent.end()) continue;
            pass.scheduler->released(unit, node.id, Scheduler::Loss::Released);
        }
    };
    for (auto& [id, live] : views_) {
        for (LivePass& pass : live.passes) {
            if (pass.scheduler) give_back(pass);
        }
    }
    for (PickTask& task : picks_) {
        if (task.pass.scheduler) give_back(task.pass);
    }
}

void LiveRunner::node_gone(NodeId node) {
    balancer_.forget(node);
    cancelled_.clear();  // some will never be confirmed
    for (auto& [id, live] : views_) {
        for (LivePass& pass : live.passes) {
            if (pass.scheduler) pass.scheduler->node_gone(node);
        }
    }
    for (PickTask& task : picks_) {
        if (task.pass.scheduler) task.pass.scheduler->node_gone(node);
    }
}

LiveView* LiveRunner::view_of(ViewId pass) {
    auto after = views_.upper_bound(pass);
    if (after == views_.begin()) return nullptr;
    LiveView& live = std::prev(after)->second;
    return pass.value - live.id.value < live.passes.size() ? &live : nullptr;
}

LivePass* LiveRunner::pass_of(ViewId view) {
    for (PickTask& task : picks_) {
        if (task.pass.view.id == view) return task.pass.scheduler ? &task.pass : nullptr;
    }
    LiveView* live = view_of(view);
    if (live == nullptr) return nullptr;
    LivePass& pass = live->passes[view.value - live->id.value];
    return pass.scheduler ? &pass : nullptr;
}

LivePass* LiveRunner::pass_of(UnitId unit) {
    const auto holds = [&](const LivePass& pass) {
        return pass.scheduler && unit >= pass.first_unit && unit.value - pass.first_unit.value < UnitsPerPass;
    };
    for (PickTask& task : picks_) {
        if (holds(task.pass)) return &task.pass;
    }
    for (auto& [id, live] : views_) {
        for (LivePass& pass : live.passes) {
            if (holds(pass)) return &pass;
        }
    }
    return nullptr;
}

void LiveRunner::take_merger_output(TimePoint now) {
    for (MergerOutput& output : merger_.take()) {
        if (const auto* report = std::get_if<MergeReport>(&output)) {
            take(*report, now);
        } else if (auto* tile = std::get_if<EncodedTile>(&output)) {
            (void)frames_.take(std::move(*tile));
        } else if (auto* made = std::get_if<Reconstructed>(&output)) {
            if (!made->picture.error.empty()) events_({wire::Severity::Error, made->picture.error});
            (void)frames_.take(std::move(*made), now);
        } else if (auto* output_made = std::get_if<MadeOutput>(&output)) {
            if (on_output) on_output(std::move(*output_made), now);
        } else if (auto* film = std::get_if<FilmBlocks>(&output)) {
            film->job == JobId{} ? take(std::move(*film)) : take_copy(std::move(*film));
        }
    }
}

void LiveRunner::take(const MergeReport& report, TimePoint now) {
    NodeRecord* node = nodes_.by_bulk(report.peer);
    if (report.part + 1 == report.parts) confirm_cancelled(report.unit, now);  // it was done already
    if (report.malformed) {
        ++malformed_film_;
        events_({wire::Severity::Warning, "malformed film was dropped"});
        return;
    }
    LivePass* pass = report.stale ? nullptr : pass_of(report.view);
    if (pass == nullptr || pass->view.revision != report.revision) return;
    Scheduler& scheduler = *pass->scheduler;
    const std::string sender = node ? " (node " + node->hello.name + ")" : std::string();
    switch (report.result.outcome) {
        case FrameAssembler::Outcome::Misfit:
            scheduler.count_refused();
            events_({wire::Severity::Error, "film that does not fit the frame was refused" + sender});
            return;
        case FrameAssembler::Outcome::Contradiction:
            events_({wire::Severity::Error, "two nodes gave different bits for the same samples" + sender});
            scheduler.count_duplicate();
            break;
        case FrameAssembler::Outcome::Duplicate:
            scheduler.count_duplicate();
            break;
        case FrameAssembler::Outcome::Merged:
            break;
    }
    if (node && report.parts == 1) balancer_.measured(node->id, report.pixel_samples, report.busy);
    cancel(scheduler.merged(report.unit, report.result.tile, report.block));
    if (LiveView* live = view_of(report.view); live != nullptr && pass == &live->pass()) advance(*live, now);
}

}  // namespace tessera::master
