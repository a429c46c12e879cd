#pragma once

#include <cstdint>
#include <vector>

#include "mediator/frame/film_tile.h"

namespace tessera::frame {

// Samples that some pixels of a tile are to get.
struct WantedSamples {
    Rect tile;
    SampleBlock block;
    PixelSet pixels;
};

// A film that can go on: its complete blocks, unmerged, in an order in which they can be inserted again (tile_film.h), and of
// an adaptive picture what is left of its current step.
struct FilmState {
    std::vector<FilmTile> blocks;
    std::uint32_t steps = 0;  // decided ones
    std::vector<WantedSamples> wanted;
};

}  // namespace tessera::frame
