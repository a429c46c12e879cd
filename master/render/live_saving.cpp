// Views and their films, for a master that is started anew.
#include <algorithm>

#include "master/render/live_runner.h"

namespace tessera::master {

namespace {
constexpr JobId SaveTag{1};  // what the merger's copies are for; 0 = a pick
}

void LiveRunner::save(Hash128 scene_hash) {
    saving_.emplace();
    for (auto& [id, live] : views_) {
        if (live.in_group) continue;
        wire::SavedView& saved = saving_->views[id];
        saved = {.name = live.name,
                 .owner_user = live.owner_user,
                 .owner_key = live.owner_key,
                 .view = live.view,
                 .spp = live.spp,
                 .scene_hash_of_film = scene_hash,
                 .blocks = {}};
        const bool accumulates = !live.restart_wanted && !live.passes.empty() && live.pass().scale == 1 &&
                                 live.pass().scheduler && live.pass().scheduler->merged_samples() > 0;
        if (!accumulates) continue;
        saving_->revisions[id] = live.revision;
        saving_->waiting.insert(live.pass().view.id);
        merger_.copy(live.pass().view.id, SaveTag);
    }
}

std::uint64_t LiveRunner::film_progress() const {
    std::uint64_t progress = next_view_ + next_unit_;  // passes take new ids
    for (const auto& [id, live] : views_) {
        if (!live.in_group && !live.passes.empty() && live.pass().scheduler)
            progress += live.pass().scheduler->merged_samples();
    }
    return progress;
}

std::optional<std::vector<wire::SavedView>> LiveRunner::take_saved() {
    if (!saving_) return std::nullopt;
    // A film that ended meanwhile does not come any more.
    std::erase_if(saving_->waiting, [this](ViewId film) {
        const LiveView* live = view_of(film);
        return live == nullptr || saving_->revisions[live->id] != live->revision;
    });
    if (!saving_->waiting.empty()) return std::nullopt;
    std::vector<wire::SavedView> views;
    for (auto& [id, saved] : saving_->views) views.push_back(std::move(saved));
    saving_.reset();
    return views;
}

void LiveRunner::take_copy(FilmBlocks&& film) {
    if (!saving_ || saving_->waiting.erase(film.view) == 0) return;
    if (const LiveView* live = view_of(film.view); live && saving_->revisions[live->id] == film.revision)
        saving_->views[live->id].blocks = std::move(film.blocks);
}

void LiveRunner::restore(std::vector<wire::SavedView>&& saved, Version version, Hash128 scene_hash,
                         TimePoint now) {
    for (wire::SavedView& old : saved) {
        if (views_.size() >= settings_.max_views) return;
        const ViewId id{next_view_};
        next_view_ += MaxPasses;
        LiveView& live = views_[id];
        live.id = id;
        live.name = old.name;
        live.owner_user = old.owner_user;
        live.owner_key = old.owner_key;
        live.view = std::move(old.view);
        live.view.id = {};
        live.view.revision = 1;
        live.spp = old.spp;
        live.asked_revision = 1;
        live.version = version;
        live.without_nodes_since = now;
        live.orphaned = now;
        // Film of another scene is of no use.
        if (old.blocks.empty() || old.scene_hash_of_film != scene_hash) continue;
        live.restart_wanted = false;
        live.revision = 1;
        live.camera_revision = live.asked_revision;
        live.passes = passes_of(live);
        live.current = live.passes.size() - 1;
        begin_pass(live.pass(), version, std::move(old.blocks));
    }
}

}  // namespace tessera::master
