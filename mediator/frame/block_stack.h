#pragma once

#include <vector>

#include "mediator/frame/film_tile.h"

namespace tessera::frame {

// A back-end's way to a unit's block: push whole-tile blocks of one sample in ascending order; equal neighbours merge
// like the carries of a binary counter. What is inside at any time is the complete prefix as its maximal aligned blocks.
class BlockStack {
  public:
    void push(FilmTile block);
    std::vector<FilmTile> take();  // ascending; leaves the stack empty
    FilmTile recycled(Rect rect, SampleBlock block,
                      ChannelSet channels);  // a tile to fill, from spent memory

  private:
    std::vector<FilmTile> blocks_;
    std::vector<FilmTile> spare_;
};

}  // namespace tessera::frame
