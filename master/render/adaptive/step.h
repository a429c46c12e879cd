#pragma once

#include <tbb/task_arena.h>

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "master/render/schedule/plan.h"
#include "mediator/frame/film_tile.h"

namespace tessera::master {

struct AdaptiveSettings {
    // Wanted part of the relMSE that the unfiltered picture has, 1 or more: it is good enough; 0: as `noise` says
    double part = 0.0;
    double noise = 0.0;         // wanted sqrt(relMSE) of the unfiltered picture; 0: the best that can be had
    std::uint64_t samples = 0;  // that all pixels may have together; 0: any number
    std::uint64_t max_samples = 0;  // of a pixel
    std::uint32_t step = 0;         // how many steps there were before
    bool uniform = false;           // all pixels are doubled
};

// Of a picture that is shown while it is rendered: `mean` samples of a pixel, at most 64 times as many of one.
AdaptiveSettings settings_of_mean(std::uint64_t mean, std::size_t pixels, std::uint32_t step, bool uniform);

// What an adaptive picture needs next. A pure function of the film, so that neither nodes nor the order of arrival matter.
struct Step {
    double noise = 0.0;                  // of the unfiltered picture so far
    double error = 0.0;                  // of the filtered one: its relMSE; 0: it was not asked for
    std::uint64_t samples_expected = 0;  // of all pixels, at the end
    std::vector<Round>
        rounds;  // by number of samples, ascending; empty: it is good enough, or may not have more
};

// Each pixel has 2^k samples; a step doubles those of some pixels. `doublings`: k, rejected samples included; 255: it gets
// no more.
//
// With relMSE d^2 / n of a pixel that has n samples, the fewest samples that lower the sum over pixels to the part
// e^2 / noise^2 of what it is now, T, are n = d sum d / T; with a number of samples for all pixels it is the part d / sum d of
// that, as far as no pixel has more already. Pixels that have less than n / sqrt(2) are doubled, those that gain most per
// sample first, until the prediction is reached or the samples are used up. One eighth of the step goes to pixels by a
// low-discrepancy order instead, because the estimate may have missed something. Where no pixel needs as much, those that gain
// most are doubled all the same, as long as there are samples.
// Without an arena in this thread; the same step either way. `deviations`: d of each pixel; empty: of the unfiltered picture.
Step next_step(const frame::FilmTile& film, std::span<const std::uint8_t> doublings,
               std::span<const Rect> tiles, const AdaptiveSettings& settings,
               tbb::task_arena* arena = nullptr, std::span<const float> deviations = {});

// Pixels of a tile, ascending, by the level of their block [2^level, 2^(level + 1)) and the index of the tile.
using PixelsByRound = std::map<std::pair<std::uint32_t, std::size_t>, std::vector<std::uint32_t>>;
std::vector<Round> rounds_of(PixelsByRound&& pixels, std::span<const Rect> tiles);

}  // namespace tessera::master
