#include "master/render/view_saver.h"

#include "master/render/adaptive/saved_step.h"

namespace tessera::master {

// The scheduler of the last pass, if that is the current one.
const Scheduler* ViewSaver::accumulating(const ViewState& view) const {
    if (view.restart_wanted || view.passes.empty() || !view.is_last_pass()) return nullptr;
    return passes_.dispatcher.find(view.pass().view.id);
}

void ViewSaver::save(Hash128 scene_hash) {
    saving_.emplace();
    for (const auto& [id, view] : views_.all()) {
        if (view.in_group()) continue;
        wire::SavedView& saved = saving_->views[id];
        saved = {.name = view.name,
                 .owner_user = view.owner.user,
                 .owner_key = view.owner.key,
                 .request = view.request,
                 .scene_hash_of_film = scene_hash,
                 .kind = view.run.kind,
                 .films = view.films,
                 .blocks = {}};
        const Scheduler* pass = accumulating(view);
        if (pass == nullptr || pass->merged_samples() == 0) continue;
        saved.steps = view.run.is_widened ? 0 : view.run.steps;
        if (saved.steps > 0) saved.step = saved_step(pass->rounds(), pass->tiles());
        saving_->revisions[id] = view.revision;
        saving_->waiting.insert(view.pass().view.id);
        passes_.film.copy(view.pass().view.id);
    }
}

std::uint64_t ViewSaver::film_progress() const {
    std::uint64_t progress = views_.ids().given();
    for (const auto& [id, view] : views_.all()) {
        if (view.in_group()) continue;
        progress += view.revision << 32;  // a restarted film is another one
        if (const Scheduler* pass = accumulating(view)) progress += pass->merged_samples();
    }
    return progress;
}

std::optional<std::vector<wire::SavedView>> ViewSaver::take_saved() {
    if (!saving_) return std::nullopt;
    // A film that was closed meanwhile will not arrive.
    std::erase_if(saving_->waiting, [this](ViewId film) {
        const ViewState* view = views_.of_pass(film);
        return view == nullptr || saving_->revisions[view->id] != view->revision;
    });
    if (!saving_->waiting.empty()) return std::nullopt;
    std::vector<wire::SavedView> views;
    for (auto& [id, saved] : saving_->views) views.push_back(std::move(saved));
    saving_.reset();
    return views;
}

bool ViewSaver::take(FilmBlocks&& film) {
    if (!saving_ || saving_->waiting.erase(film.view) == 0) return false;
    const ViewState* view = views_.of_pass(film.view);
    if (view != nullptr && saving_->revisions[view->id] == film.revision)
        saving_->views[view->id].blocks = std::move(film.blocks);
    return true;
}

}  // namespace tessera::master
