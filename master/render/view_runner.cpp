#include "master/render/view_runner.h"

#include <algorithm>
#include <bit>

#include "master/render/view_summary.h"

namespace tessera::master {

using session::Outcome;
using session::Phase;

// ---- from the request to its passes ----

void ViewRunner::restart(ViewState& view, TimePoint now) {
    passes_.end_all(view);
    ++view.revision;
    ++view.films;
    view.camera_revision = view.asked_revision;
    view.restart_wanted = false;
    view.failed_tiles.clear();
    view.run = {.started = now,
                .without_nodes_since = now,
                .kind = view.earlier_kind,
                .cost_key = cost_key(view.request),
                .bytes_before = views_.bytes_at_start};
    wait_for_nodes(view, now);
}

void ViewRunner::resume(ViewState& view, EarlierFilm&& earlier, const std::string& kind, TimePoint now) {
    view.restart_wanted = false;
    ++view.revision;
    view.camera_revision = view.asked_revision;
    view.run = {.phase = Phase::Rendering,
                .started = now,
                .rendering_since = now,
                .without_nodes_since = now,
                .kind = kind,
                .cost_key = cost_key(view.request),
                .steps = earlier.steps,
                .bytes_before = views_.bytes_at_start};
    view.passes = passes_of(view);
    view.current = view.passes.size() - 1;
    begin_pass(view, std::move(earlier));
}

void ViewRunner::wait_for_nodes(ViewState& view, TimePoint now) {
    const auto prospects = passes_.dispatcher.prospects(view.request.view, requirements(view));
    Run& run = view.run;
    if (prospects.ready >= view.request.min_nodes) {
        if (budget_is_planned(view, now)) begin_rendering(view, now);
        return;
    }
    const bool enough = prospects.suitable >= view.request.min_nodes;
    run.phase = enough ? Phase::Syncing : Phase::WaitingForNodes;
    // Syncing takes as long as it takes, while there is progress.
    if (enough && (prospects.building > 0 || prospects.scene_bytes != run.synced_bytes))
        run.without_nodes_since = now;
    run.synced_bytes = prospects.scene_bytes;
    if (view.request.wait_limit == Duration::zero() ||
        now - run.without_nodes_since < view.request.wait_limit)
        return;
    decide(
        view, Outcome::NoNodes,
        passes_.dispatcher.obstacles(view.request.view, requirements(view)) +
            std::to_string(prospects.ready) + " of " + std::to_string(view.request.min_nodes) +
            (enough ? " nodes are ready, and the others do not receive the scene: see the log of their master"
                    : " nodes are ready: start more nodes or ask for fewer with --wait-nodes"),
        now);
}

void ViewRunner::begin_rendering(ViewState& view, TimePoint now) {
    Run& run = view.run;
    run.scale = view.earlier ? 1 : scale_that_fits(view, now);
    run.phase = Phase::Rendering;
    run.rendering_since = now;
    view.passes = passes_of(view);
    if (view.earlier) {
        view.current = view.passes.size() - 1;
        EarlierFilm earlier = *std::exchange(view.earlier, std::nullopt);
        run.steps = earlier.steps;
        begin_pass(view, std::move(earlier));
        run.samples_before = passes_.dispatcher.find(view.pass().view.id)->merged_samples();
        return advance(view, now);
    }
    for (Pass& pass : view.passes) {  // pixels without features are only blurred
        if (pass.kind == Pass::Kind::Features) pass.deadline = now + (*run.deadline - now) / 2;
    }
    view.current = 0;
    begin_pass(view);
    advance(view, now);
}

PlanSettings ViewRunner::plan_of(const ViewState& view) const {
    const Pass& pass = view.pass();
    PlanSettings plan{.window = pass.view.window,
                      .tile = choose_tile_edge(view.request.view, view.request.tile),
                      .spp = pass.spp,
                      .policy = view.request.policy,
                      .max_crashes = settings_.max_crashes};
    if (pass.kind == Pass::Kind::Coarse) {
        // Enough tiles to keep all workers busy until the end, but none below 8 pixels.
        constexpr std::uint64_t TilesPerWorker = 6;
        const std::uint32_t workers = passes_.dispatcher.prospects(pass.view, requirements(view)).workers;
        plan.tile = 8;
        for (const std::uint32_t edge : {16u, 32u}) {
            if (pass.view.window.pixel_count() >= TilesPerWorker * std::max(1u, workers) * edge * edge)
                plan.tile = edge;
        }
    }
    // A client that waits for the end sees no picture before 4 samples. With a deadline shorter rounds are used, but
    // with a budget the filter needs a variance, which takes 2.
    if (pass.kind == Pass::Kind::Picture && !view.shows_all())
        plan.first_level = !view.run.deadline ? 2u : view.request.stop.has_budget() ? 1u : 0u;
    if (pass.kind == Pass::Kind::Picture && view.request.has_steps()) {
        plan.is_adaptive = true;
        plan.spp = session::StopRule::AdaptiveBase;
    }
    // No picture is shown before the end.
    if (!view.shows_all() && !view.run.deadline) plan.hold_film = std::chrono::seconds(2);
    return plan;
}

void ViewRunner::begin_pass(ViewState& view, EarlierFilm&& earlier) {
    PlanSettings plan = plan_of(view);
    // Before the first decision all pixels need the same number of samples, a power of two.
    if (plan.is_adaptive && earlier.steps == 0) {
        for (const frame::FilmTile& block : earlier.blocks)
            plan.spp = std::max(plan.spp, std::min(std::bit_ceil(block.block.end()), view.request.stop.spp));
    }
    passes_.begin(view.pass(), plan, requirements(view), view.run.deadline, std::move(earlier));
    Scheduler& scheduler = *passes_.dispatcher.find(view.pass().view.id);
    view.run.samples_expected = scheduler.merged_samples() + scheduler.remaining_samples();
    // What failed in a coarse pass would fail again, and cost more nodes.
    for (std::uint32_t tile = 0; tile < scheduler.tiles().size(); ++tile) {
        const Rect rect = in_full_size(view, view.pass(), scheduler.tiles()[tile]);
        for (const session::FailedTile& failed : view.failed_tiles) {
            if (intersection(rect, failed.rect).empty()) continue;
            scheduler.give_up({tile, {}, failed.message});
            break;
        }
    }
}

// ---- from pass to pass ----

void ViewRunner::advance(ViewState& view, TimePoint now) {
    Run& run = view.run;
    if (drops_test_patterns(view) || run.is_over()) return;
    if (view.passes.empty()) {
        if (!view.restart_wanted && !run.outcome && !run.is_rendering()) wait_for_nodes(view, now);
        return;
    }
    observe(view, now);
    if (fails_everywhere(view)) return give_up(view, now);
    if (run.outcome || view.is_last_pass()) {
        advance_picture(view, now);
    } else {
        advance_to_next_pass(view, now);
    }
}

// Null nodes began the picture, and a node that renders the scene has joined: the view starts over without them.
bool ViewRunner::drops_test_patterns(ViewState& view) {
    const bool may_restart = !view.passes.empty() && (!view.run.outcome || view.shows_all());
    if (!may_restart || !passes_.dispatcher.is_superseded(view.pass().view.id)) return false;
    events_({wire::Severity::Info,
             "view " + view.name + " starts over: its film has test patterns of null nodes",
             {.view = view.id}});
    passes_.end_all(view);
    view.restart_wanted = true;
    return true;
}

void ViewRunner::observe(ViewState& view, TimePoint now) {
    const Scheduler& pass = *passes_.dispatcher.find(view.pass().view.id);
    Run& run = view.run;
    run.samples = pass.merged_samples();
    run.units = pass.counts();
    run.seen_at = now;
    if (view.request.reproducible && run.kind.empty())
        run.kind = passes_.dispatcher.kind(view.pass().view.id);
    const bool is_picture = view.pass().kind != Pass::Kind::Features;
    if (!run.first_picture && is_picture && pass.tiles_without_samples() == 0) run.first_picture = now;
}

void ViewRunner::advance_to_next_pass(ViewState& view, TimePoint now) {
    Pass& pass = view.pass();
    const Scheduler& scheduler = *passes_.dispatcher.find(pass.view.id);
    const bool is_over = scheduler.complete() || (pass.deadline && now >= *pass.deadline);
    if (!is_over) return;
    collect_failed_tiles(view);
    if (pass.kind == Pass::Kind::Coarse) {
        show(view, now);
        if (views_.passes_paused || view.restart_wanted) return;
    } else {
        passes_.dispatcher.end(pass.view.id);
        passes_.film.retain_as_features(pass.view.id, view.passes.back().view.id);
    }
    ++view.current;
    begin_pass(view);
}

void ViewRunner::advance_picture(ViewState& view, TimePoint now) {
    const Scheduler& scheduler = *passes_.dispatcher.find(view.pass().view.id);
    const session::StopRule& stop = view.request.stop;
    Run& run = view.run;
    const bool is_whole = scheduler.tiles_without_samples() == 0;
    if (!run.outcome) {
        const auto prospects = passes_.dispatcher.prospects(view.pass().view, requirements(view));
        if (prospects.ready > 0) run.without_nodes_since = now;
        if (scheduler.complete()) {
            collect_failed_tiles(view);
            const bool is_whole_picture = view.failed_tiles.empty();
            decide(view, is_whole_picture ? Outcome::Complete : Outcome::Incomplete,
                   is_whole_picture ? "" : failed_tiles_text(view), now);
        } else if (stop.time_is_up(run.deadline, is_whole, now)) {
            decide(view, Outcome::TimeUp, {}, now);
        } else if (view.request.wait_limit > Duration::zero() &&
                   now - run.without_nodes_since >= view.request.wait_limit) {
            decide(
                view, Outcome::NoNodes,
                (run.kind.empty() ? "all nodes"
                                  : "the frame is reproducible on kind " + run.kind + ", and all its nodes") +
                    " have disconnected: the samples merged so far are delivered",
                now);
        }
    }
    if (!run.outcome && view.request.has_steps() && scheduler.paused()) request_step(view, now);
    const bool is_settled = scheduler.idle() || now - run.outcome_at > settings_.stop_grace;
    if (run.outcome && !run.is_over() && is_settled && !scheduler.is_merging()) return finish(view, now);
    if (is_whole) show(view, now);
}

void ViewRunner::took(ViewState& view, const MergeReport& report, Dispatcher::Taken taken, TimePoint now) {
    account(view, report, taken);
    if (!view.passes.empty() && view.pass().view.id == report.view) advance(view, now);
}

void ViewRunner::account(ViewState& view, const MergeReport& report, Dispatcher::Taken taken) {
    if (taken != Dispatcher::Taken::New) return;
    view.run.rays += report.rays;
    view.run.nonfinite_samples += report.nonfinite;
    if (const auto node = passes_.dispatcher.sender(report)) {
        session::NodeSummary& part = view.run.nodes[node->id];
        const session::NodeSummary before = part;
        part = *node;
        part.units = before.units + report.units;
        part.samples = before.samples + report.pixel_samples;
        part.seconds_busy = before.seconds_busy + seconds(report.busy);
    }
}

void ViewRunner::show(ViewState& view, TimePoint now) {
    const DisplayedState shown{.pass = view.current,
                               .revision = view.revision,
                               .asked = view.camera_revision,
                               .samples = passes_.dispatcher.find(view.pass().view.id)->merged_samples(),
                               .complete = view.run.is_over()};
    if (view.shown == shown) return;
    const bool is_first = !view.shown || view.shown->revision != view.revision;
    view.shown = shown;
    if (is_first) first_pictures_.push_back({view.version, now});
    delivery_.send_frames(view, now, settings_.frame_interval);  // before a newer pass ends this one
    for (std::size_t earlier = 0; earlier < view.current; ++earlier)
        passes_.end(view.passes[earlier].view.id);
}

// ---- the end ----

void ViewRunner::decide(ViewState& view, Outcome outcome, std::string message, TimePoint now) {
    if (view.run.outcome) return;
    view.restart_wanted = false;  // it may not have begun
    view.run.outcome = outcome;
    view.run.outcome_at = now;
    view.run.message = std::move(message);
    if (!view.passes.empty()) passes_.dispatcher.cancel(view.pass().view.id);
    if (!view.run.is_rendering()) finish(view, now);
}

void ViewRunner::finish(ViewState& view, TimePoint now) {
    Run& run = view.run;
    if (!view.passes.empty()) {
        passes_.dispatcher.seal(view.pass().view.id);
        observe(view, now);
        run.left_out = passes_.dispatcher.left_out(view.pass().view.id);
    }
    const bool is_awaited = delivery_.watchers(view.id) > 0;
    run.phase = is_awaited && has_picture(view, view.request.picture) ? Phase::Filtering : Phase::Delivering;
    if (run.phase == Phase::Delivering) run.ended = now;
    send_progress(view, now);
    if (!view.passes.empty()) return show(view, now);
    view.shown = DisplayedState{.revision = view.revision, .asked = view.camera_revision, .complete = true};
    delivery_.send_frames(view, now, settings_.frame_interval);
}

void ViewRunner::take(Reconstructed&& made, TimePoint now) {
    if (!made.picture.error.empty()) events_({wire::Severity::Error, made.picture.error});
    const auto ended = delivery_.ends(made.frame);
    ViewState* view = ended ? views_.find(*ended) : nullptr;
    if (view != nullptr && view->run.phase == Phase::Filtering) {
        Run& run = view->run;
        if (view->request.stop.has_budget() && run.outcome == Outcome::TimeUp && run.deadline) {
            time_budget_.measured(run.cost_key, view->request.view.window.pixel_count(),
                                  seconds(now - *run.deadline));
        }
        if (!made.picture.error.empty()) {
            run.outcome = Outcome::Failed;
            run.message = made.picture.error;
        }
        run.phase = Phase::Delivering;
        run.ended = now;
        send_progress(*view, now);
    }
    delivery_.take(made, now);
}

void ViewRunner::take(const CalibrationResult& calibration) {
    if (const ViewState* view = views_.find(calibration.view))
        time_budget_.measured(view->run.cost_key, calibration.pixels, calibration.seconds);
}

// ---- tiles that no node can render ----

void ViewRunner::collect_failed_tiles(ViewState& view) {
    const Scheduler& scheduler = *passes_.dispatcher.find(view.pass().view.id);
    for (const TileFailure& failure : scheduler.failed_tiles()) {
        const session::FailedTile tile{
            .rect = in_full_size(view, view.pass(), scheduler.tiles()[failure.tile]),
            .samples = scheduler.ledger().samples(failure.tile).sample_count(),
            .message = failure.message};
        // The parts of a tile that failed in a coarser pass are smaller.
        const bool is_known = std::any_of(view.failed_tiles.begin(), view.failed_tiles.end(),
                                          [&](const session::FailedTile& known) {
                                              return intersection(known.rect, tile.rect) == tile.rect;
                                          });
        if (!is_known) view.failed_tiles.push_back(tile);
    }
}

bool ViewRunner::fails_everywhere(const ViewState& view) const {
    const Scheduler& scheduler = *passes_.dispatcher.find(view.pass().view.id);
    const std::size_t limit = std::min<std::size_t>(settings_.failure_limit, scheduler.tiles().size());
    return !view.run.outcome && scheduler.merged_samples() == 0 && scheduler.failed_tiles().size() >= limit;
}

void ViewRunner::give_up(ViewState& view, TimePoint now) {
    fail(view, passes_.dispatcher.find(view.pass().view.id)->failed_tiles().front().message, now);
}

void ViewRunner::fail(ViewState& view, const std::string& problem, TimePoint now) {
    if (!view.shows_all() && !view.run.outcome) return decide(view, Outcome::Failed, problem, now);
    view.problem = problem;
    view.restart_wanted = false;
    const std::string text = "view " + view.name + " is not rendered: " + problem;
    events_({wire::Severity::Error, text, {.session = view.owner.session, .view = view.id}});
    notify_owner(view, text);
    passes_.end_all(view);
}

// ---- another filter ----

void ViewRunner::change_filter(ViewState& view, const FilterChange& change, TimePoint now) {
    view.request.view.filter = change.view.filter;
    view.request.view.channels = change.view.channels;
    view.run.cost_key = cost_key(view.request);
    if (view.passes.empty()) return;
    Pass& picture = view.passes.back();
    picture.view.filter = change.view.filter;
    if (change.effect == FilterChange::Effect::Widened) {
        picture.view.channels = change.view.channels;
        if (view.is_last_pass()) {
            view.run.is_widened = true;
            // Units in flight lack the channels: they are dealt again under a new revision.
            picture.view.revision = ++view.revision;
            if (view.shown) view.shown->revision = view.revision;
            passes_.dispatcher.revise(picture.view);
            passes_.film.add_channels(picture.view.id, view.revision, picture.view.channels);
        }
    }
    if (view.shown && view.is_last_pass()) show(view, now);
}

// ---- notifications ----

void ViewRunner::notify_owner(const ViewState& view, const std::string& text) {
    if (view.in_group()) events_({wire::Severity::Warning, text, {.view = view.id}});
    if (const SessionRecord* owner = sessions_.find(view.owner.session))
        outbox_.control(owner->control, wire::Notice{wire::Severity::Warning, text});
}

void ViewRunner::notify_waiting(ViewState& view, TimePoint now) {
    if (!view.shows_all()) return;  // its owner receives progress reports
    const bool has_node = passes_.dispatcher.prospects(view.request.view, requirements(view)).suitable > 0;
    if (has_node || view.is_complete()) {
        view.waits_since = now;
        view.wait_notified = false;
    }
    if (view.wait_notified || now - view.waits_since < settings_.patience_without_nodes) return;
    view.wait_notified = true;
    const std::size_t count = passes_.dispatcher.node_count();
    notify_owner(view, "view " + view.name + " waits: " +
                           (count == 0 ? "there are no nodes: start some with tessera-node"
                                       : passes_.dispatcher.obstacles(view.request.view, requirements(view)) +
                                             "none of " + std::to_string(count) + " nodes can render it"));
}

void ViewRunner::show_progress(ViewState& view, TimePoint now) {
    if (view.run.phase == Phase::Delivering || now - view.progress_sent < settings_.progress_interval) return;
    send_progress(view, now);
}

void ViewRunner::send_progress(ViewState& view, TimePoint now) {
    view.progress_sent = now;
    delivery_.report_progress(view,
                              passes_.dispatcher.prospects(view.request.view, requirements(view)).ready);
}

session::ViewProgress ViewRunner::progress(const ViewState& view) const {
    return progress_of(view, passes_.dispatcher.prospects(view.request.view, requirements(view)).ready);
}

TimePoint ViewRunner::next_event(const ViewState& view, TimePoint now) const {
    if (view.is_complete() && view.run.phase != Phase::Filtering)
        return now + Duration(std::chrono::seconds(1));
    TimePoint next = now + (view.shows_all() ? settings_.frame_interval : settings_.progress_interval);
    if (view.run.outcome) return next;
    for (const auto& deadline :
         {view.passes.empty() ? std::nullopt : view.pass().deadline, view.run.deadline}) {
        if (deadline && now < *deadline) next = std::min(next, *deadline);
    }
    return next;
}

}  // namespace tessera::master
