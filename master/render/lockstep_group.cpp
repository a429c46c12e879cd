#include "master/render/lockstep_group.h"

#include <algorithm>
#include <bit>

namespace tessera::master {

void LockstepGroup::open(std::uint64_t spp, std::uint32_t coarsest, Version version) {
    open_.emplace(Open{.spp = std::bit_floor(std::max<std::uint64_t>(spp, 1)),
                       .coarsest = coarsest,
                       .version = version,
                       .views = {}});
}

std::vector<ViewId> LockstepGroup::close() {
    std::vector<ViewId> views = this->views();
    open_.reset();
    return views;
}

const std::vector<ViewId>& LockstepGroup::views() const {
    static const std::vector<ViewId> none;
    return open_ ? open_->views : none;
}

void LockstepGroup::changed() {
    if (open_) open_->restart_wanted = true;
}

void LockstepGroup::resample() {
    if (open_) open_->resample_wanted = true;
}

void LockstepGroup::scene_changed(Version version, bool restarts) {
    if (!open_) return;
    open_->version = version;
    open_->restart_wanted = open_->restart_wanted || restarts;
}

bool LockstepGroup::is_restart_due() const {
    if (!open_ || !open_->restart_wanted || views_.passes_paused) return false;
    return open_->first_is_consumed ||
           std::none_of(open_->views.begin(), open_->views.end(),
                        [this](ViewId view) { return views_.find(view)->awaiting_first_frame(); });
}

// Larger for cheap pixels: a unit has a constant message overhead, but must be cancellable quickly, and all nodes
// should stay busy until the end.
std::uint32_t LockstepGroup::tile_edge(const view::View& view) const {
    constexpr double UnitSeconds = 0.01;
    constexpr double UnitsPerWorker = 6.0;
    constexpr std::uint32_t UnknownEdge = 64, LargestEdge = 256;
    constexpr std::uint64_t MaxUnitBytes = std::uint64_t{1} << 20;
    const auto prospects = passes_.dispatcher.prospects(view, {open_->version});
    double pixels = 0.0;
    for (const ViewId other : open_->views)
        pixels += static_cast<double>(views_.find(other)->request.view.window.pixel_count());
    double area = prospects.slowest_worker > 0.0 ? prospects.slowest_worker * UnitSeconds
                                                 : double(UnknownEdge) * UnknownEdge;
    area = std::min(area, pixels / (UnitsPerWorker * std::max(1u, prospects.workers)));
    std::uint32_t edge = 8;
    while (edge < LargestEdge && 4.0 * edge * edge <= area) edge *= 2;
    while (std::uint64_t{edge} * edge * 4 * (1 + view.channels.plane_count()) > MaxUnitBytes) edge /= 2;
    return edge;
}

// If the number of views is the same they keep their ids, so that nodes replace them instead of closing them first.
std::vector<ViewId> LockstepGroup::restart(const std::vector<GroupView>& wanted, TimePoint now) {
    Open& group = *open_;
    std::vector<ViewId> removed;
    group.restart_wanted = group.resample_wanted = false;
    group.first_is_consumed = group.complete = false;
    group.samples = 0;
    group.decided.clear();
    group.is_deciding = group.has_last_samples = false;
    if (wanted.size() != group.views.size()) {
        removed = std::exchange(group.views, {});
        for (const GroupView& view : wanted) {
            ViewState& state = views_.add();
            state.group_priority = view.priority;
            state.waits_since = now;
            group.views.push_back(state.id);
        }
    }
    // Stages are the same for all views: the smallest view limits the coarse passes.
    std::uint32_t coarsest = group.coarsest;
    for (const GroupView& asked : wanted) {
        while (coarsest > 1 && !has_coarse_pass(asked.view, coarsest)) coarsest /= 2;
    }
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        ViewState& view = *views_.find(group.views[i]);
        view.name = wanted[i].name;
        view.group_priority = wanted[i].priority;
        view.request.view = wanted[i].view;
        view.request.stop.spp = group.spp * wanted[i].priority;
        const bool can_step = view.request.view.channels.contains(frame::Channel::BlockVariance) &&
                              group.spp > session::StopRule::AdaptiveBase;
        view.request.stop.uniform = !can_step;
        view.version = group.version;
        view.restart_wanted = false;
        view.problem.clear();
        view.camera_revision = ++view.revision;
        ++view.films;
        for (std::size_t old = 1; old < view.passes.size(); ++old) passes_.end(view.passes[old].view.id);
        view.passes = passes_of(view, coarsest);
        view.current = 0;
        view.shown.reset();
        view.run = {.phase = session::Phase::Rendering, .started = now, .rendering_since = now};
        begin_pass(view);
    }
    return removed;
}

void LockstepGroup::begin_pass(ViewState& view) {
    Pass& pass = view.pass();
    PlanSettings plan{.window = pass.view.window, .tile = tile_edge(pass.view), .spp = pass.spp};
    if (view.is_last_pass() && view.request.has_steps()) {
        plan.is_adaptive = true;
        plan.spp = session::StopRule::AdaptiveBase * view.priority();
    }
    passes_.begin(pass, plan, {view.version}, std::nullopt);
    if (!view.is_last_pass()) return;
    passes_.dispatcher.find(pass.view.id)
        ->hold_at(std::max<std::uint64_t>(open_->samples, 1) * view.priority());
}

bool LockstepGroup::is_whole() const {
    return std::all_of(open_->views.begin(), open_->views.end(), [this](ViewId id) {
        const ViewState& view = *views_.find(id);
        const Scheduler* pass = view.passes.empty() ? nullptr : passes_.dispatcher.find(view.pass().view.id);
        return pass != nullptr && pass->tiles_without_samples() == 0;
    });
}

bool LockstepGroup::is_stage_done() const {
    return std::all_of(open_->views.begin(), open_->views.end(), [this](ViewId id) {
        const ViewState& view = *views_.find(id);
        const Scheduler* pass = view.passes.empty() ? nullptr : passes_.dispatcher.find(view.pass().view.id);
        return pass != nullptr && pass->paused();
    });
}

std::optional<GroupStage> LockstepGroup::advance(Consumer consumer) {
    if (!open_ || open_->views.empty()) return std::nullopt;
    Open& group = *open_;
    group.is_first_stage = false;
    // While films are incomplete, their stage is going to be consumed anyway.
    if (group.resample_wanted && group.first_is_consumed && is_whole()) {
        if (consumer == Consumer::Free) {
            group.resample_wanted = false;
            return stage();
        }
    } else {
        group.resample_wanted = false;
    }
    if (group.complete || group.is_deciding || !is_stage_done()) return std::nullopt;
    const bool is_picture = views_.find(group.views.front())->is_last_pass();
    if (is_picture) group.samples = std::max<std::uint64_t>(group.samples, 1);
    const bool is_last = is_picture && is_last_stage();
    if (consumer == Consumer::Free) {
        if (mark_shown(is_last)) {
            group.is_first_stage = !std::exchange(group.first_is_consumed, true);
            return stage();
        }
    } else if (!group.first_is_consumed || is_last) {
        return std::nullopt;
    }
    if (is_last) {
        group.complete = true;
    } else if (!group.restart_wanted && !views_.passes_paused) {
        advance_views();
    }
    return std::nullopt;
}

// False: this stage has been consumed already, and the next one had to wait.
bool LockstepGroup::mark_shown(bool is_last) {
    for (const ViewId id : open_->views) {
        ViewState& view = *views_.find(id);
        const DisplayedState shown{.pass = view.current,
                                   .revision = view.revision,
                                   .asked = view.camera_revision,
                                   .samples = passes_.dispatcher.find(view.pass().view.id)->merged_samples(),
                                   .complete = is_last};
        if (view.shown == shown) return false;
        view.shown = shown;
        for (std::size_t earlier = 0; earlier < view.current; ++earlier)
            passes_.end(view.passes[earlier].view.id);
    }
    return true;
}

bool LockstepGroup::is_last_stage() const {
    const bool any_steps = std::any_of(open_->views.begin(), open_->views.end(),
                                       [this](ViewId id) { return views_.find(id)->request.has_steps(); });
    return any_steps ? open_->has_last_samples : open_->samples >= open_->spp;
}

// Those that have the samples of the first decision.
std::vector<ViewState*> LockstepGroup::views_with_steps() {
    std::vector<ViewState*> views;
    if (open_->samples < session::StopRule::AdaptiveBase) return views;
    for (const ViewId id : open_->views) {
        ViewState& view = *views_.find(id);
        if (view.is_last_pass() && view.request.has_steps()) views.push_back(&view);
    }
    return views;
}

void LockstepGroup::request_step(ViewState& view) {
    const AdaptiveSettings settings =
        settings_of_mean(open_->spp * view.priority(), view.pass().view.window.pixel_count(), view.run.steps,
                         view.run.step_is_uniform);
    std::vector<std::uint32_t> closed;
    for (const TileFailure& failure : passes_.dispatcher.find(view.pass().view.id)->failed_tiles())
        closed.push_back(failure.tile);
    passes_.film.decide(view.pass().view, settings, 0.0, std::move(closed));
}

void LockstepGroup::take(ViewState& view, StepDecision&& decision) {
    if (!open_ || !open_->is_deciding || view.passes.empty() || view.pass().view.id != decision.view ||
        view.pass().view.revision != decision.revision)
        return;
    const bool is_dark = decision.step.rounds.empty() && decision.step.noise == 0.0;
    if (is_dark && !std::exchange(view.run.step_is_uniform, true)) return request_step(view);
    view.run.step_is_uniform = false;
    view.run.noise = decision.step.noise;
    ++view.run.steps;
    open_->decided[view.id] = std::move(decision.step.rounds);
    const std::vector<ViewState*> deciding = views_with_steps();
    if (open_->decided.size() < deciding.size()) return;
    open_->is_deciding = false;
    open_->has_last_samples = open_->samples >= open_->spp || deciding.size() == open_->views.size();
    for (auto& [id, rounds] : std::exchange(open_->decided, {})) {
        if (rounds.empty()) continue;
        open_->has_last_samples = false;
        Scheduler& pass = *passes_.dispatcher.find(views_.find(id)->pass().view.id);
        pass.hold_at(2 * session::MaxSamplesPerPixel);  // never: a step ends by itself
        pass.begin_step(std::move(rounds));
    }
    if (!open_->has_last_samples) return;
    for (const ViewState* other : deciding) passes_.dispatcher.find(other->pass().view.id)->begin_step({});
}

void LockstepGroup::advance_views() {
    const bool is_picture = views_.find(open_->views.front())->is_last_pass();
    const std::vector<ViewState*> stepping = is_picture ? views_with_steps() : std::vector<ViewState*>();
    if (is_picture) open_->samples = std::min(2 * open_->samples, open_->spp);
    open_->is_deciding = !stepping.empty();
    for (const ViewId id : open_->views) {
        ViewState& view = *views_.find(id);
        if (std::ranges::find(stepping, &view) != stepping.end()) {
            request_step(view);
        } else if (is_picture) {
            passes_.dispatcher.find(view.pass().view.id)->hold_at(open_->samples * view.priority());
        } else {
            ++view.current;
            begin_pass(view);
        }
    }
}

GroupStage LockstepGroup::stage() const {
    GroupStage stage{.scene = {open_->version, views_.last_edits}, .views = {}};
    for (const ViewId id : open_->views) {
        const ViewState& view = *views_.find(id);
        stage.scene.version = view.version;
        stage.scale = view.pass().scale;
        stage.views.push_back(view.pass().view);
    }
    return stage;
}

}  // namespace tessera::master
