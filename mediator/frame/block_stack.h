#pragma once

#include <vector>

#include "mediator/frame/film_tile.h"

namespace tessera::frame {

// Accumulates the samples of a work unit: push blocks of one sample in ascending order; siblings merge like carries of
// a binary counter. At any time it holds the samples so far as maximal aligned blocks.
class BlockStack {
  public:
    void push(FilmTile block);
    std::vector<FilmTile> take();  // ascending; leaves the stack empty
    // A tile without samples, in reused memory.
    FilmTile recycled(Rect rect, SampleBlock block, ChannelSet channels, const PixelSet& pixels = {});

  private:
    std::vector<FilmTile> blocks_;
    std::vector<FilmTile> spare_;
};

}  // namespace tessera::frame
