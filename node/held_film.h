#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "mediator/base/clock.h"
#include "mediator/wire/messages.h"

namespace tessera::node {

// Finished film that waits for the other half of its block, which this node is going to render, too: the halves are merged
// before they are sent, as the master would do, so that consecutive short units cost the network one film. Pure.
class HeldFilm {
  public:
    struct Item {
        wire::FilmPart film;
        std::vector<UnitId> units;  // that it completes
        TimePoint since{};          // when its oldest unit was finished
    };
    void add(wire::FilmPart film, TimePoint now);

    // Removes and returns the items that need not wait any longer. `is_coming`: whether the node has a unit that lies in
    // the other half of the item's block; `limit`: how long film of its view may wait.
    std::vector<Item> take_ready(const std::function<bool(const wire::FilmPart&)>& is_coming,
                                 const std::function<Duration(ViewId)>& limit, TimePoint now);
    std::optional<Item> take(UnitId unit);  // the item with this unit
    std::vector<Item> take_view(ViewId view);
    std::vector<Item> take_all();

    bool empty() const { return items_.empty(); }
    std::size_t unit_count() const;
    // When the first item will have waited for its limit.
    std::optional<TimePoint> next_event(const std::function<Duration(ViewId)>& limit) const;

  private:
    std::vector<Item> items_;
};

// Whether a unit's film could be merged into it, directly or with others of the same half.
bool is_in_other_half(const wire::FilmPart& film, const view::WorkUnit& unit);

}  // namespace tessera::node
