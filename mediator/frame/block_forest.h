#pragma once

#include <map>
#include <vector>

#include "mediator/frame/film_tile.h"

namespace tessera::frame {

// The film of one tile and the ledger of who contributed, in one: a set of disjoint aligned blocks. Siblings merge at
// once, so the roots are the fewest blocks that cover what is there, whatever the order of arrival.
class BlockForest {
  public:
    enum class Outcome {
        Merged,         // new samples
        Duplicate,      // already inside, same bits where they can be compared
        Replaced,       // contained smaller blocks, which it replaces
        Contradiction,  // an equal block with other bits is there: a broken promise, kept out
    };

    Outcome insert(FilmTile block);

    bool covers(const SampleBlock& block) const;
    std::uint64_t sample_count() const;  // per pixel, rejected ones included
    std::vector<SampleBlock> roots() const;
    std::vector<SampleBlock> missing(std::uint64_t spp) const;                   // of [0, spp), ascending
    const std::map<std::uint64_t, FilmTile>& blocks() const { return blocks_; }  // by first sample
    FilmTile merged()
        const;  // the roots folded in ascending order of first sample; empty forest: a tile without pixels

  private:
    std::map<std::uint64_t, FilmTile> blocks_;
};

}  // namespace tessera::frame
