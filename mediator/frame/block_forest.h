#pragma once

#include <functional>
#include <map>
#include <vector>

#include "mediator/frame/film_tile.h"

namespace tessera::frame {

// The film of one tile as a set of disjoint aligned blocks of samples. Siblings are merged immediately, so the roots
// are the fewest blocks that cover the received samples, independent of the order of arrival.
class BlockForest {
  public:
    enum class Outcome {
        Merged,     // new samples
        Duplicate,  // already contained, with the same bits if it can be compared
        Replaced,   // contained smaller blocks, which it replaces
        Conflict,   // the same block exists with other bits: rejected
        Overlap,    // contains blocks that it may not replace: rejected
    };

    // `may_replace`: of the smaller blocks that it contains; empty: any.
    Outcome insert(FilmTile block, const std::function<bool(const SampleBlock&)>& may_replace = {});

    bool covers(const SampleBlock& block) const;
    std::uint64_t sample_count() const;  // per pixel, rejected ones included
    std::vector<SampleBlock> roots() const;
    std::vector<SampleBlock> missing(std::uint64_t spp) const;                   // of [0, spp), ascending
    const std::map<std::uint64_t, FilmTile>& blocks() const { return blocks_; }  // by first sample
    FilmTile merged()
        const;  // the roots merged in order of their first sample; an empty forest gives a tile without pixels

  private:
    std::map<std::uint64_t, FilmTile> blocks_;
};

}  // namespace tessera::frame
