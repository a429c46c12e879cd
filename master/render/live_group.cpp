// Views in lockstep: those of a display.
#include <algorithm>
#include <bit>
#include <cmath>

#include "master/peers/suitable_nodes.h"
#include "master/render/job.h"
#include "master/render/live_runner.h"

namespace tessera::master {

void LiveRunner::open_group(GroupOwner owner, std::uint64_t spp, std::uint32_t coarsest, Version version) {
    close_group();
    group_.emplace(ViewGroup{.owner = std::move(owner),
                             .spp = std::bit_floor(std::max<std::uint64_t>(spp, 1)),
                             .coarsest = coarsest,
                             .version = version});
}

void LiveRunner::close_group() {
    if (!group_) return;
    for (const ViewId view : group_->views) remove(view);
    group_.reset();
}

void LiveRunner::group_changed() {
    if (group_) group_->restart_wanted = true;
}

void LiveRunner::take_group_again() {
    if (group_) group_->retake_wanted = true;
}

void LiveRunner::make_output(OutputOrder order) {
    merger_.make_output(std::move(order));
}

bool LiveRunner::group_is_protected() const {
    return group_ && !group_->first_is_taken &&
           std::any_of(group_->views.begin(), group_->views.end(),
                       [this](ViewId view) { return views_.at(view).is_protected(); });
}

// As large as the work is cheap: a unit costs messages whatever its size, but must be stopped soon, and all
// nodes are to be busy until the end.
std::uint32_t LiveRunner::group_tile_edge(const view::View& view, Version version) const {
    constexpr double UnitSeconds = 0.01;
    constexpr double UnitsPerWorker = 6.0;
    constexpr std::uint32_t UnknownEdge = 64, LargestEdge = 256;
    constexpr std::uint64_t MaxUnitBytes = std::uint64_t{1} << 20;
    double workers = 0.0, slowest = 0.0, pixels = 0.0;
    for (const auto& [id, node] : nodes_.all()) {
        if (!suits(node, view, version)) continue;
        workers += std::max(1u, node.hello.concurrent_units);
        const double rate = balancer_.rate(id);
        if (rate > 0.0) slowest = slowest > 0.0 ? std::min(slowest, rate) : rate;
    }
    for (const ViewId other : group_->views)
        pixels += static_cast<double>(views_.at(other).view.window.pixel_count());
    double area = slowest > 0.0 ? slowest * UnitSeconds : double(UnknownEdge) * UnknownEdge;
    area = std::min(area, pixels / (UnitsPerWorker * std::max(1.0, workers)));
    std::uint32_t edge = 8;
    while (edge < LargestEdge && 4.0 * edge * edge <= area) edge *= 2;
    while (std::uint64_t{edge} * edge * 4 * (1 + view.channels.plane_count()) > MaxUnitBytes) edge /= 2;
    return edge;
}

// The same views again keep their ids, so that nodes replace what they have instead of forgetting it first.
void LiveRunner::restart_group() {
    ViewGroup& group = *group_;
    const std::vector<GroupView> wanted = group.owner.views();
    group.restart_wanted = false;
    group.retake_wanted = false;
    group.first_is_taken = false;
    group.complete = false;
    group.samples = 0;
    if (wanted.size() != group.views.size()) {
        for (const ViewId view : group.views) remove(view);
        group.views.clear();
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            const ViewId id{next_view_};
            next_view_ += MaxPasses;
            LiveView& live = views_[id];
            live.id = id;
            live.in_group = true;
            live.without_nodes_since = now_;
            group.views.push_back(id);
        }
    }
    // Stages are the same for all: what is too small for a coarse picture decides.
    std::uint32_t coarsest = group.coarsest;
    for (const GroupView& asked : wanted) {
        while (coarsest > 1 && !has_coarse_pass(asked.view, coarsest)) coarsest /= 2;
    }
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        LiveView& live = views_.at(group.views[i]);
        live.name = wanted[i].name;
        live.priority = wanted[i].priority;
        live.view = wanted[i].view;
        live.spp = group.spp * live.priority;
        live.version = group.version;
        live.restart_wanted = false;
        live.problem.clear();
        live.camera_revision = ++live.revision;
        std::vector<LivePass> passes = passes_of(live, coarsest);
        for (std::size_t old = 0; old < live.passes.size(); ++old) {
            LivePass& pass = live.passes[old];
            if (old != 0) {
                end(pass);
            } else if (pass.scheduler) {
                cancel(pass.scheduler->cancel_everything());
                add(counts_, pass.scheduler->counts());
            }
        }
        live.passes = std::move(passes);
        live.current = 0;
        live.shown.reset();
        begin_group_pass(live);
    }
}

void LiveRunner::begin_group_pass(LiveView& live) {
    LivePass& pass = live.pass();
    begin_pass(pass, live.version);
    if (pass.scale == 1) pass.scheduler->hold_at(std::max<std::uint64_t>(group_->samples, 1) * live.priority);
}

// Where films are not whole, their stage is going to be taken anyway.
void LiveRunner::retake_group(TimePoint now) {
    ViewGroup& group = *group_;
    const bool is_whole = std::all_of(group.views.begin(), group.views.end(), [this](ViewId view) {
        const LiveView& live = views_.at(view);
        return !live.passes.empty() && live.pass().scheduler &&
               live.pass().scheduler->tiles_without_samples() == 0;
    });
    if (group.first_is_taken && is_whole) {
        if (!group.owner.can_take()) return;
        group.owner.take(stage_of_group(), now);
    }
    group.retake_wanted = false;
}

void LiveRunner::advance_group(TimePoint now) {
    if (!group_ || group_->views.empty()) return;
    if (group_->retake_wanted) retake_group(now);
    if (group_->complete) return;
    ViewGroup& group = *group_;
    const bool is_done = std::all_of(group.views.begin(), group.views.end(), [this](ViewId view) {
        const LiveView& live = views_.at(view);
        return !live.passes.empty() && live.pass().scheduler && live.pass().scheduler->paused();
    });
    if (!is_done) return;
    const LiveView& leader = views_.at(group.views.front());
    const bool is_whole = leader.pass().scale == 1;
    if (is_whole) group.samples = std::max<std::uint64_t>(group.samples, 1);
    const bool is_last = is_whole && group.samples >= group.spp;
    if (group.owner.can_take()) {
        show_group(is_last, now);
    } else if (!group.first_is_taken || is_last) {
        return;
    }
    if (is_last) {
        group.complete = true;
    } else if (group.restart_wanted || passes_held_) {
        return;
    } else if (is_whole) {
        group.samples *= 2;
        for (const ViewId view : group.views) {
            LiveView& live = views_.at(view);
            live.pass().scheduler->hold_at(group.samples * live.priority);
        }
    } else {
        for (const ViewId view : group.views) {
            LiveView& live = views_.at(view);
            ++live.current;
            begin_group_pass(live);
        }
    }
}

GroupStage LiveRunner::stage_of_group() const {
    GroupStage stage{.version = group_->version, .views = {}};
    for (const ViewId view : group_->views) {
        const LiveView& live = views_.at(view);
        stage.version = live.version;
        stage.scale = live.pass().scale;
        stage.views.push_back(live.pass().view);
    }
    return stage;
}

void LiveRunner::show_group(bool is_last, TimePoint now) {
    ViewGroup& group = *group_;
    for (const ViewId view : group.views) {
        LiveView& live = views_.at(view);
        const Shown shown{.pass = live.current,
                          .revision = live.revision,
                          .samples = live.pass().scheduler->merged_samples(),
                          .complete = is_last};
        if (live.shown == shown) return;  // this stage was taken, and the next one had to wait
        live.shown = shown;
    }
    const GroupStage stage = stage_of_group();
    const bool is_first = !std::exchange(group.first_is_taken, true);
    if (is_first && on_first_picture) on_first_picture(stage.version, now);
    group.owner.take(stage, now);
    for (const ViewId view : group.views) {
        LiveView& live = views_.at(view);
        frames_.offer(live, now, settings_.frame_interval);
        for (std::size_t earlier = 0; earlier < live.current; ++earlier) end(live.passes[earlier]);
    }
}

}  // namespace tessera::master
