#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "master/render/pass_starter.h"
#include "mediator/wire/journal_records.h"

namespace tessera::master {

// Views with their films as values, for a master that is started anew.
class ViewSaver {
  public:
    ViewSaver(ViewTable& views, PassStarter& passes) : views_(views), passes_(passes) {}

    // Has all films copied; they are there when take_saved() brings them. `scene_hash`: of what they show.
    void save(Hash128 scene_hash);
    bool is_saving() const { return saving_.has_value(); }
    std::optional<std::vector<wire::SavedView>> take_saved();
    // Grows whenever there is more or other film to save.
    std::uint64_t film_progress() const;

    bool take(FilmBlocks&& film);  // false: nobody asked for it

  private:
    // A save under way.
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
