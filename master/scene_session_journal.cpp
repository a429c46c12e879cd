// The scene's files: its journal and checkpoints.
#include <algorithm>

#include "master/scene_session.h"

namespace tessera::master {

void SceneSession::record_to(const std::filesystem::path& folder, Duration checkpoint_interval,
                             TimePoint now) {
    journal_.emplace(folder, checkpoint_interval, authority_, services_.blobs, services_.events);
    services_.jobs.record_to(folder / "jobs");  // the journal has locked the folder
    const Recovery& recovery = journal_->recovery();
    if (!recovery.found || recovery.scene.title.empty()) {
        (void)authority_.clear();
        published_ = authority_.published();
        return;
    }
    journal_->opened(recovery.scene);
    opened(recovery.scene);
    published_ = authority_.published();
    std::vector<wire::SavedView> views = recovery.views;
    std::erase_if(views, [this](const wire::SavedView& view) {  // ended before its end was recorded
        return view.request.detached && services_.jobs.find({view.owner_user, view.name}) != nullptr;
    });
    std::erase_if(views, [this](const wire::SavedView& view) {
        const std::string problem = problem_of(view.request);
        if (!problem.empty()) {
            services_.events({wire::Severity::Error, "view '" + view.name + "' of " + view.owner_user +
                                                         " is not continued: " + problem});
        }
        return !problem.empty();
    });
    const bool has_only_jobs =
        !views.empty() &&
        std::all_of(views.begin(), views.end(), [](const auto& view) { return view.request.detached; });
    if (is_exclusive() && !has_only_jobs) owner_missing_since_ = now;  // its owner may return
    views_.restore(std::move(views), published_.version(), published_.state_hash(), now);
}

void SceneSession::keep_journal(TimePoint now) {
    if (!journal_) return;
    journal_->tick();
    if (is_editing()) return;
    write_saved_views(now);
    ViewSaver& saver = views_.saver();
    const std::uint64_t progress = saver.film_progress();
    if (saver.is_saving() || !journal_->wants_checkpoint(progress, now)) return;
    progress_being_saved_ = progress;
    saver.save(published_.state_hash());
}

void SceneSession::write_saved_views(TimePoint now) {
    if (auto saved = views_.saver().take_saved()) {
        add_new_jobs(*saved);
        journal_->write_checkpoint(scene_, std::move(*saved), progress_being_saved_, now);
    }
}

bool SceneSession::save_at_the_end(TimePoint now) {
    if (is_editing()) return false;
    if (!journal_) return true;
    journal_->tick();
    write_saved_views(now);
    ViewSaver& saver = views_.saver();
    if (saver.is_saving() || journal_->is_writing()) return false;
    const std::uint64_t progress = saver.film_progress();
    if (!journal_->has_news(progress) || journal_->last_write_failed()) return true;
    progress_being_saved_ = progress;
    saver.save(published_.state_hash());
    return false;
}

}  // namespace tessera::master
