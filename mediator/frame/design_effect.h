#pragma once

#include <tbb/task_arena.h>

#include <span>
#include <vector>

#include "mediator/frame/film_tile.h"

namespace tessera::frame {

// Variance of the mean of a pixel's samples, relative to that of as many independent samples: below 1 where samples are
// stratified. One number per pixel, in (0, 1]; to be multiplied by M2 / (n (n - 1)) of any channel. 1 where the film has no
// BlockVariance.
//
// By the squared differences between the halves of blocks, pooled over 9 x 9 pixels. That of the whole block is the error of
// its mean if the halves are independent; in a sequence that is stratified better with each doubling it is too large, and
// the halves' own says by how much: with a ratio c of the two, the error is divided by sqrt(c - 1), where c = 2 is random
// sampling and c = 2 sqrt(2) that of an edge: halfway, on a logarithmic scale, between the bound and what it would be if the
// decrease went on as between the last two levels.
class DesignEffect {
  public:
    // Valid until the next call, which reuses the memory. Without an arena in this thread; the same bits either way.
    std::span<const float> measure(const FilmTile& film, tbb::task_arena* arena = nullptr);

  private:
    void measure_rows(const FilmTile& film, std::size_t first, std::size_t last, std::span<double> scratch);

    std::vector<float> effects_;
    std::vector<double> scratch_;
};

}  // namespace tessera::frame
