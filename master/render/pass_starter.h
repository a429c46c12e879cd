#pragma once

#include <vector>

#include "master/render/dispatcher.h"
#include "master/render/film_store.h"
#include "master/render/view_table.h"
#include "mediator/wire/journal_records.h"

namespace tessera::master {

// What there was of a pass before the master was restarted.
struct EarlierFilm {
    std::vector<frame::FilmTile> blocks;
    std::uint32_t steps = 0;            // of an adaptive pass: decided ones
    std::vector<wire::SavedPart> step;  // the last one
};

// Begins and ends the passes of views: their units and their films together.
struct PassStarter {
    Dispatcher& dispatcher;
    FilmStore& film;

    // Replaces an earlier pass with the id of this view.
    void begin(Pass& pass, const PlanSettings& plan, const NodeRequirements& requirements,
               std::optional<TimePoint> deadline, EarlierFilm&& earlier = {});
    void end(ViewId pass);
    void end_all(ViewState& view);  // its passes and displayed state
};

}  // namespace tessera::master
