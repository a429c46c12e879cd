#pragma once

#include <vector>

#include "master/render/dispatcher.h"
#include "master/render/film_store.h"
#include "master/render/view_table.h"

namespace tessera::master {

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
