#pragma once

#include <tbb/task_arena.h>

#include <span>
#include <vector>

#include "master/render/adaptive/step.h"
#include "mediator/filter/choice.h"
#include "mediator/frame/film_tile.h"
#include "mediator/view/view.h"

namespace tessera::master {

// Channels of the film that the estimate reads, with those of the filter.
inline constexpr frame::ChannelSet ErrorEstimateChannels{
    frame::Channel::Radiance, frame::Channel::BlockVariance, frame::Channel::FirstHalf};

// Error of the picture that a filter makes of half of a film's samples: its variance and its bias. That of all samples is
// smaller, but light that was not found yet is missing in it.
//
// The filter runs on each half. With filtered pictures F, G and unfiltered ones U, V of the two halves, which have independent
// errors, the expectation of ((F + G) / 2)^2 - F V - G U + U V is the squared error of (F + G) / 2, and that of (F - G)^2 / 4 is the
// variance in it; a single half has twice the variance, and the same bias.
//
// Variance is relative to the brightness of the unfiltered picture, as its noise is (mediator/picture/noise_map.h); bias to that of the
// filtered one, since the samples of a pixel must not decide how much their own errors count: pixels that found little would count
// too much. So a filter that blurs light over darkness is judged too kindly: the true error of `gauss` and `guided` on a checker of
// black was 2 to 3 times the estimate. Features and variances are those of all samples, as the film has no halves of them.
class FilteredError {
  public:
    // That it takes while it is made, without the filter: all channels twice, and what is computed.
    static std::size_t bytes_per_pixel(const frame::ChannelSet& film) { return 8 * film.plane_count() + 160; }

    // Of a film of all pixels of its rectangle, with ErrorEstimateChannels and those of the filter.
    FilteredError(const frame::FilmTile& film, const view::View& view, const filter::Choice& choice,
                  tbb::task_arena& arena);

    double relmse() const { return relmse_; }
    // Square root of the relMSE that its variance would give a pixel with one sample, averaged over 9 x 9 pixels: where samples
    // lower it (NoiseMap::deviations()).
    const std::vector<float>& deviations() const { return deviations_; }

  private:
    std::vector<float> deviations_;
    double relmse_ = 0.0;
};

// The relMSE to reach of the picture that the view's filter makes.
struct ErrorGoal {
    view::View view;
    double error = 0.0;
};

// Part of the unfiltered picture's relMSE that is to be left, so that a filtered picture with the relMSE `error` has the wanted
// one, which falls more slowly.
double part_to_reach(double wanted, double error);

// next_step() to the wanted error of the filtered picture, for the pixels where that has its error; settings.noise and settings.part are
// not read. Of unfiltered pictures the error is their squared noise. Throws Error if the filter cannot run.
Step next_step_to(const ErrorGoal& goal, const frame::FilmTile& film, std::span<const std::uint8_t> doublings,
                  std::span<const Rect> tiles, AdaptiveSettings settings, tbb::task_arena& arena);

}  // namespace tessera::master
