#include "master/render/live_runner.h"

#include <algorithm>

#include "master/peers/suitable_nodes.h"
#include "master/render/job.h"
#include "master/render/picture_effect.h"

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

std::string LiveRunner::open(const Owner& owner, wire::OpenLiveView request, Version version, TimePoint now) {
    const SessionId session = owner.session;
    now_ = now;
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
    if (request.name.empty()) request.name = owner.name + "/" + std::to_string(request.number);
    if (const auto known = named(request.name); known != views_.end() && known->first != watched) {
        const bool is_owner = known->second.owner_user == owner.user && known->second.owner_key == owner.key;
        if (!known->second.orphaned || !is_owner) {
            return "a view named '" + request.name + "' is there already: choose another name, or share it";
        }
        watched = known->first;  // its owner is back
    }
    if (watched && views_.at(*watched).owner != session && !views_.at(*watched).orphaned) watched.reset();
    if (!watched) {
        const std::size_t count = views_.size() - (group_ ? group_->views.size() : 0);
        if (count >= settings_.max_views) {
            return "there are " + std::to_string(count) + " views already: close some";
        }
        watched = ViewId{next_view_};
        next_view_ += MaxPasses;
        LiveView& live = views_[*watched];
        live.id = *watched;
        live.without_nodes_since = now;
    }
    LiveView& live = views_.at(*watched);
    live.owner = session;
    live.owner_name = owner.name;
    live.owner_user = owner.user;
    live.owner_key = owner.key;
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
    if (view && frames_.watchers(*view) == 0 && !views_.at(*view).in_group) remove(*view);
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
    close_group();
    while (!views_.empty()) remove(views_.begin()->first);
    for (PickTask& task : picks_) end(task.pass);
    picks_.clear();
}

// ---- passes ----

void LiveRunner::begin_pass(LivePass& pass, Version version, std::vector<frame::FilmTile>&& film) {
    const LiveView* const live = view_of(pass.view.id);
    const bool live_in_group = live != nullptr && live->in_group;
    std::uint32_t workers = 0;
    for (const auto& [id, node] : nodes_.all()) {
        if (suits(node, pass.view, version)) workers += std::max(1u, node.hello.concurrent_units);
    }
    const PlanSettings plan{
        .window = pass.view.window,
        .tile = live_in_group ? group_tile_edge(pass.view, version) : tile_edge(pass, workers),
        .spp = pass.spp,
        .policy = wire::Policy::Mixed,
        .first_level = 0};
    pass.first_unit = next_units();
    pass.scheduler.emplace(plan, pass.view.id, pass.view.revision, version, pass.first_unit, std::nullopt);
    FrameAssembler assembler(pass.scheduler->tiles(), pass.view.channels, pass.spp);
    for (frame::FilmTile& block : film) {
        const frame::SampleBlock samples = block.block;
        const FrameAssembler::Result result = assembler.insert(std::move(block));
        if (result.outcome == FrameAssembler::Outcome::Merged)
            (void)pass.scheduler->merged(UnitId{}, result.tile, samples);
    }
    merger_.open(pass.view.id, pass.view.revision, std::move(assembler));
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

void LiveRunner::restart(LiveView& live) {
    end_passes(live);
    ++live.revision;
    live.camera_revision = live.asked_revision;
    live.passes = passes_of(live);
    live.restart_wanted = false;
    begin_pass(live.pass(), live.version);
}

// The pass under way has new samples.
void LiveRunner::advance(LiveView& live, TimePoint now) {
    if (live.in_group) return advance_group(now);
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
    if (first && on_first_picture) on_first_picture(live.version, now);
    frames_.offer(live, now, settings_.frame_interval);  // before anything newer ends the pass
    for (std::size_t earlier = 0; earlier < live.current; ++earlier) end(live.passes[earlier]);
}

void LiveRunner::fail(LiveView& live, const std::string& problem) {
    live.problem = problem;
    const std::string text = "view " + live.name + " is not rendered: " + problem;
    events_({wire::Severity::Error, text});
    tell_owner(live, text);
    end_passes(live);
}

void LiveRunner::tell_owner(const LiveView& live, const std::string& text) {
    if (live.in_group) events_({wire::Severity::Warning, text});
    if (const SessionRecord* owner = sessions_.find(live.owner))
        outbox_.control(owner->control, wire::Notice{wire::Severity::Warning, text});
}

// Once, as long as it lasts.
void LiveRunner::tell_of_waiting(LiveView& live, TimePoint now) {
    const bool has_node = std::any_of(nodes_.all().begin(), nodes_.all().end(), [&](const auto& node) {
        return suits(node.second, live.view, live.version);
    });
    if (has_node || live.is_complete()) {
        live.without_nodes_since = now;
        live.told_of_waiting = false;
    }
    if (live.told_of_waiting || now - live.without_nodes_since < settings_.patience_without_nodes) return;
    live.told_of_waiting = true;
    const std::size_t count = nodes_.all().size();
    tell_owner(live, "view " + live.name + " waits: " +
                         (count == 0 ? "there are no nodes: start some with tessera-node"
                                     : obstacles(nodes_, live.view, live.version) + "none of " +
                                           std::to_string(count) + " nodes can render it"));
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

bool LiveRunner::scene_changed(const scene::ChangeList& changes, const scene::Scene& after, TimePoint now) {
    now_ = now;
    const bool restarts = changes_pictures(changes, after);
    if (group_) {
        group_->version = changes.to;
        group_->restart_wanted = group_->restart_wanted || restarts;
    }
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
    return restarts;
}

// ---- time ----

void LiveRunner::tick(TimePoint now) {
    now_ = now;
    take_merger_output(now);
    if (views_.empty() && picks_.empty() && !group_) return;
    std::vector<ViewId> forgotten;
    for (const auto& [id, live] : views_) {
        if (live.orphaned && frames_.watchers(id) == 0 && now - *live.orphaned > settings_.orphan_patience)
            forgotten.push_back(id);
    }
    for (const ViewId view : forgotten) remove(view);
    for (auto& [id, live] : views_) tell_of_waiting(live, now);
    // A pass that waited for changes to be published goes on.
    advance_group(now);
    for (auto& [id, live] : views_) {
        if (!live.in_group && !live.passes.empty() && live.pass().scheduler &&
            live.pass().scheduler->complete())
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
        if (!live.in_group && !live.passes.empty() && live.current + 1 == live.passes.size() &&
            live.pass().scheduler && live.pass().scheduler->tiles_without_samples() == 0) {
            show(live, now);
        }
        frames_.offer(live, now, settings_.frame_interval);
    }
}

TimePoint LiveRunner::next_event(TimePoint now) const {
    if (views_.empty() && picks_.empty() && !group_) return TimePoint::max();
    const bool all_complete = std::all_of(views_.begin(), views_.end(),
                                          [](const auto& entry) { return entry.second.is_complete(); });
    return now +
           (all_complete && picks_.empty() ? Duration(std::chrono::seconds(1)) : settings_.frame_interval);
}

}  // namespace tessera::master
