#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "master/render/pass_starter.h"
#include "mediator/wire/journal_records.h"

namespace tessera::master {

// Saves views with their films, for a master restart.
class ViewSaver {
  public:
    ViewSaver(ViewTable& views, PassStarter& passes) : views_(views), passes_(passes) {}

    // Requests copies of all films; take_saved() returns them when they are complete. `scene_hash`: of the scene in the films.
    void save(Hash128 scene_hash);
    bool is_saving() const { return saving_.has_value(); }
    std::optional<std::vector<wire::SavedView>> take_saved();
    // Increases whenever film has changed since the last save.
    std::uint64_t film_progress() const;

    bool take(FilmBlocks&& film);  // false: not requested by save()

  private:
    // A save in progress.
    struct Saving {
        std::map<ViewId, wire::SavedView> views;
        std::map<ViewId, std::uint64_t> revisions;  // of the views whose film is being copied
        std::set<ViewId> waiting;                   // films
    };
    const Scheduler* accumulating(const ViewState& view) const;

    ViewTable& views_;
    PassStarter& passes_;
    std::optional<Saving> saving_;
};

}  // namespace tessera::master
