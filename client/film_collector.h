#pragma once

#include <optional>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/frame/film_tile.h"
#include "mediator/wire/messages.h"

namespace tessera::client {

// Puts the tiles of one job together to the film of the whole window. Tiles may come in any order, twice, and
// before it is known how many there are.
class FilmCollector {
  public:
    FilmCollector(JobId job, Rect window, frame::ChannelSet channels);

    // InvalidInput: the tile reaches outside the window, lacks a channel, or is one too many. Tiles of
    // other jobs are ignored.
    Expected<void> add(const wire::FrameTile& tile);
    std::uint32_t count() const { return count_; }  // different tiles
    frame::FilmTile take() { return std::move(film_); }

  private:
    JobId job_;
    frame::ChannelSet wanted_;
    frame::FilmTile film_;
    std::vector<bool> seen_;  // by index
    std::uint32_t count_ = 0;
};

}  // namespace tessera::client
