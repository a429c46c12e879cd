#include "master/live/live_runner.h"

#include <algorithm>
#include <cmath>

#include "master/job.h"
#include "master/live/picture_effect.h"

namespace tessera::master {

namespace {

constexpr std::uint64_t MaxFilmBytes = std::uint64_t{128} << 20;  // of a view whose film goes to a client

std::uint32_t tile_edge(const LivePass& pass, std::uint32_t workers) {
    if (pass.scale == 1) return choose_tile_edge({.view = pass.view});
    // So many tiles that nobody idles while the last are rendered, but none below 8 pixels.
    constexpr std::uint64_t TilesPerWorker = 6;
    for (const std::uint32_t edge : {32u, 16u}) {
        if (pass.view.window.pixel_count() >= TilesPerWorker * std::max(1u, workers) * edge * edge)
            return edge;
    }
    return 8;
}

}  // namespace

LiveRunner::LiveRunner(const LiveSettings& settings, NodeTable& nodes, SessionTable& sessions, Outbox& outbox,
                       EventSink events, std::function<void()> wake)
    : settings_(settings),
      nodes_(nodes),
      sessions_(sessions),
      outbox_(outbox),
      events_(std::move(events)),
      merger_(std::move(wake)),
      frames_(sessions, outbox, merger_) {}

UnitId LiveRunner::next_units() {
    const UnitId first{next_unit_};
    next_unit_ += UnitsPerPass;
    return first;
}

std::string LiveRunner::open(SessionId session, const std::string& member, wire::OpenLiveView request,
                             Version version, TimePoint now) {
    const FrameSender::Wish wish{request.picture, request.film};
    const auto named = [&](const std::string& name) {
        return std::find_if(views_.begin(), views_.end(),
                            [&](const auto& entry) { return entry.second.name == name; });
    };
    if (request.share) {
        const auto found = named(request.name);
        if (found == views_.end()) {
            return "no view is named '" + request.name + "': ask for the views that there are";
        }
        frames_.watch(session, request.number, found->first, wish);
        return {};
    }
    wire::StartJob like{.view = request.view, .spp = request.spp, .picture = request.picture, .film = true};
    if (std::string problem = problem_of(like); !problem.empty()) return problem;
    complete(request.view);
    const std::uint64_t film_bytes =
        4 * (1 + request.view.channels.plane_count()) * request.view.window.pixel_count();
    if (request.film && film_bytes > MaxFilmBytes) {
        return "the statistics of this view have " + std::to_string(film_bytes >> 20) +
               " MiB a frame, more than 128: ask for a picture, fewer channels or a smaller window";
    }
    auto watched = frames_.watched(session, request.number);
    if (request.name.empty()) request.name = member + "/" + std::to_string(request.number);
    if (const auto known = named(request.name); known != views_.end() && known->first != watched) {
        if (!known->second.orphaned || known->second.owner_name != member) {
            return "a view named '" + request.name + "' is there already: choose another name, or share it";
        }
        watched = known->first;  // its owner is back
    }
    if (watched && views_.at(*watched).owner != session && !views_.at(*watched).orphaned) watched.reset();
    if (!watched) {
        if (views_.size() >= settings_.max_views) {
            return "there are " + std::to_string(views_.size()) + " views already: close some";
        }
        watched = ViewId{next_view_};
        next_view_ += MaxPasses;
        LiveView& live = views_[*watched];
        live.id = *watched;
        live.without_nodes_since = now;
    }
    LiveView& live = views_.at(*watched);
    live.owner = session;
    live.owner_name = member;
    live.name = request.name;
    live.orphaned.reset();
    frames_.watch(session, request.number, live.id, wish);
    view::View wanted = std::move(request.view);
    wanted.id = live.view.id;
    wanted.revision = live.view.revision;
    const bool same = live.asked_revision != 0 && wanted == live.view && live.spp == request.spp;
    if (same) return {};
    live.view = std::move(wanted);
    live.spp = request.spp;
    ++live.asked_revision;
    live.failures = 0;
    live.problem.clear();
    const bool wait = live.is_protected();
    live.restart_wanted = true;
    if (!wait) end_passes(live);
    live.version = version;
    return {};
}

void LiveRunner::close(SessionId session, std::uint64_t number) {
    const auto view = frames_.watched(session, number);
    frames_.leave(session, number);
    if (view && frames_.watchers(*view) == 0) remove(*view);
}

void LiveRunner::session_left(SessionId session, Departure departure, TimePoint now) {
    const std::vector<std::uint64_t> numbers = frames_.numbers(session);
    std::erase_if(picks_, [&](PickTask& task) {
        if (task.session != session) return false;
        end(task.pass);
        return true;
    });
    for (const std::uint64_t number : numbers) {
        if (departure == Departure::Goodbye) {
            close(session, number);
            continue;
        }
        const ViewId view = *frames_.watched(session, number);
        frames_.leave(session, number);
        LiveView& live = views_.at(view);
        if (frames_.watchers(view) == 0 || live.owner == session) live.orphaned = now;
    }
}

void LiveRunner::remove(ViewId view) {
    const auto place = views_.find(view);
    if (place == views_.end()) return;
    end_passes(place->second);
    frames_.forget(view);
    views_.erase(place);
}

void LiveRunner::close_all() {
    while (!views_.empty()) remove(views_.begin()->first);
    for (PickTask& task : picks_) end(task.pass);
    picks_.clear();
}

// ---- passes ----

void LiveRunner::begin_pass(LivePass& pass, Version version) {
    std::uint32_t workers = 0;
    for (const auto& [id, node] : nodes_.all()) {
        if (suits(node, pass.view, version)) workers += std::max(1u, node.hello.concurrent_units);
    }
    const PlanSettings plan{.window = pass.view.window,
                            .tile = tile_edge(pass, workers),
                            .spp = pass.spp,
                            .policy = wire::Policy::Mixed,
                            .first_level = 0};
    pass.first_unit = next_units();
    pass.scheduler.emplace(plan, pass.view.id, pass.view.revision, version, pass.first_unit, std::nullopt);
    merger_.open(pass.view.id, pass.view.revision,
                 FrameAssembler(pass.scheduler->tiles(), pass.view.channels, pass.spp));
}

void LiveRunner::end(LivePass& pass) {
    if (!pass.scheduler) return;
    cancel(pass.scheduler->cancel_everything());
    add(counts_, pass.scheduler->counts());
    pass.scheduler.reset();
    merger_.close(pass.view.id);
    for (auto& [id, node] : nodes_.all()) {
        if (node.views.erase(pass.view.id) > 0) outbox_.control(node.control, wire::CloseView{pass.view.id});
    }
}

void LiveRunner::end_passes(LiveView& live) {
    for (LivePass& pass : live.passes) end(pass);
    live.passes.clear();
    live.current = 0;
    live.shown.reset();
}

void LiveRunner::restart(LiveView& live, TimePoint now) {
    end_passes(live);
    ++live.revision;
    live.camera_revision = live.asked_revision;
    live.passes = passes_of(live);
    live.restart_wanted = false;
    live.without_nodes_since = now;
    begin_pass(live.pass(), live.version);
}

// The pass under way has new samples.
void LiveRunner::advance(LiveView& live, TimePoint now) {
    LivePass& pass = live.pass();
    const bool is_last = live.current + 1 == live.passes.size();
    const bool is_whole = pass.scheduler->tiles_without_samples() == 0;
    if (is_last ? is_whole : pass.scheduler->complete()) show(live, now);
    if (is_last || !pass.scheduler->complete() || live.restart_wanted || passes_held_) return;
    ++live.current;
    begin_pass(live.pass(), live.version);
}

void LiveRunner::show(LiveView& live, TimePoint now) {
    const LivePass& pass = live.pass();
    const Shown shown{.pass = live.current,
                      .revision = live.revision,
                      .samples = pass.scheduler->merged_samples(),
                      .complete = pass.scale == 1 && pass.scheduler->complete()};
    if (live.shown == shown) return;
    const bool first = !live.shown || live.shown->revision != live.revision;
    live.shown = shown;
    live.shown_at = now;
    if (first && on_first_picture) on_first_picture(live.version, now);
    frames_.offer(live, now, settings_.frame_interval);  // before anything newer ends the pass
    for (std::size_t earlier = 0; earlier < live.current; ++earlier) end(live.passes[earlier]);
}

void LiveRunner::fail(LiveView& live, const std::string& problem) {
    live.problem = problem;
    events_({wire::Severity::Error, "view " + live.name + " is not rendered: " + problem});
    end_passes(live);
}

bool LiveRunner::may_publish() const {
    return std::none_of(views_.begin(), views_.end(), [this](const auto& entry) {
        const LiveView& live = entry.second;
        // Without a node that could render it there is nothing to wait for.
        return live.is_protected() &&
               std::any_of(nodes_.all().begin(), nodes_.all().end(),
                           [&](const auto& node) { return suits(node.second, live.view, live.version); });
    });
}

void LiveRunner::scene_changed(const scene::ChangeList& changes, const scene::Scene& after, TimePoint) {
    const bool restarts = changes_pictures(changes, after);
    for (auto& [id, live] : views_) {
        live.version = changes.to;
        if (restarts) {
            live.problem.clear();
            live.failures = 0;
            live.restart_wanted = true;
            for (LivePass& pass : live.passes) {
                if (pass.scheduler) cancel(pass.scheduler->cancel_everything());
            }
            end_passes(live);
        } else {
            for (LivePass& pass : live.passes) {
                if (pass.scheduler) pass.scheduler->follow(changes.to);
            }
        }
    }
    for (PickTask& task : picks_) {
        task.version = changes.to;
        if (task.pass.scheduler) task.pass.scheduler->follow(changes.to);
    }
}

// ---- nodes ----

bool LiveRunner::suits(const NodeRecord& node, const view::View& view, Version version) const {
    return !node.leaving && !node.stuck && node.bulk && node.refused != version &&
           (view.channels.bits() & ~node.hello.channels.bits()) == 0 &&
           node.hello.renderers.contains(view.renderer);
}

bool LiveRunner::ready(const NodeRecord& node, const view::View& view, Version version) const {
    return suits(node, view, version) && node.reported == version && node.state.version == version;
}

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
    for (auto& [id, live] : views_) {
        if (live.restart_wanted && !passes_held_ && !live.is_protected() && live.problem.empty())
            restart(live, now);
        if (!live.passes.empty() && live.pass().scheduler) order.push_back(&live);
    }
    if (order.empty()) return;
    // Those without a picture first, then those with the fewest samples; equals take turns.
    std::rotate(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(turn_++ % order.size()),
                order.end());
    std::stable_sort(order.begin(), order.end(), [](const LiveView* a, const LiveView* b) {
        const auto rank = [](const LiveView& live) {
            const double pixels = static_cast<double>(live.view.window.pixel_count());
            const double spp =
                live.pass().scale > 1 ? 0.0 : double(live.pass().scheduler->merged_samples()) / pixels;
            return std::pair(-static_cast<int>(live.pass().scale), std::floor(spp));
        };
        return rank(*a) < rank(*b);
    });
    for (LiveView* live : order) deal(live->pass(), live->version, capacities, now);
}

void LiveRunner::cancel(const std::vector<Cancellation>& cancellations) {
    std::map<NodeId, std::vector<UnitId>> by_node;
    for (const Cancellation& cancellation : cancellations)
        by_node[cancellation.node].push_back(cancellation.unit);
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

void LiveRunner::released(NodeRecord& node, const wire::UnitReleased& release) {
    node.pending.erase(release.unit);
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
    for (auto& [id, live] : views_) {
        for (LivePass& pass : live.passes) {
            if (pass.scheduler) pass.scheduler->node_gone(node);
        }
    }
    for (PickTask& task : picks_) {
        if (task.pass.scheduler) task.pass.scheduler->node_gone(node);
    }
}

// ---- film ----

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
        } else if (const auto* film = std::get_if<FilmBlocks>(&output)) {
            take(*film);
        }
    }
}

void LiveRunner::take(const MergeReport& report, TimePoint now) {
    NodeRecord* node = nodes_.by_bulk(report.peer);
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

// ---- time ----

void LiveRunner::tick(TimePoint now) {
    take_merger_output(now);
    if (views_.empty() && picks_.empty()) return;
    std::vector<ViewId> forgotten;
    for (const auto& [id, live] : views_) {
        if (live.orphaned && frames_.watchers(id) == 0 && now - *live.orphaned > settings_.orphan_patience)
            forgotten.push_back(id);
    }
    for (const ViewId view : forgotten) remove(view);
    // A pass that waited for changes to be published goes on.
    for (auto& [id, live] : views_) {
        if (!live.passes.empty() && live.pass().scheduler && live.pass().scheduler->complete())
            advance(live, now);
    }
    collect_overdue(now);
    deal(now);
    send_frames(now);
    std::erase_if(picks_, [&](PickTask& task) {
        if (!task.pass.scheduler) return true;
        if (task.pass.scheduler->complete() && !task.copied) {
            merger_.copy(task.pass.view.id, JobId{0});
            task.copied = true;
        }
        return false;
    });
}

void LiveRunner::send_frames(TimePoint now) {
    for (auto& [id, live] : views_) {
        // What accumulates is newer than what was shown last.
        if (!live.passes.empty() && live.current + 1 == live.passes.size() && live.pass().scheduler &&
            live.pass().scheduler->tiles_without_samples() == 0) {
            show(live, now);
        }
        frames_.offer(live, now, settings_.frame_interval);
    }
}

TimePoint LiveRunner::next_event(TimePoint now) const {
    if (views_.empty() && picks_.empty()) return TimePoint::max();
    const bool all_complete = std::all_of(views_.begin(), views_.end(),
                                          [](const auto& entry) { return entry.second.is_complete(); });
    return now +
           (all_complete && picks_.empty() ? Duration(std::chrono::seconds(1)) : settings_.frame_interval);
}

}  // namespace tessera::master
