#pragma once

#include <optional>

#include "master/render/adaptive/filtered_error.h"
#include "tests/bench/filters/sampler.h"

namespace tessera::tools::bench {

// A film with samples where they are needed, as a cluster deals them.
struct AdaptiveFilm {
    frame::FilmTile whole;
    std::uint64_t samples = 0;  // of all pixels
    double noise = 0.0;         // as estimated
    double error = 0.0;         // likewise, with a goal
    std::uint32_t steps = 0;
    double seconds_sampling = 0.0, seconds_deciding = 0.0;  // wall-clock time
};

// The view has Radiance and BlockVariance; with a `goal`, also FirstHalf and the channels of the view's filter. Nothing when it
// was stopped.
std::optional<AdaptiveFilm> adaptive_film(const Sampler& sampler, const view::View& view,
                                          const master::AdaptiveSettings& settings, const double* goal,
                                          tbb::task_arena& arena, const std::stop_token& stop);

// Samples per second of units with a mask of a quarter of the pixels, drawn at random, over those of whole tiles. Nothing
// when it was stopped.
std::optional<double> masked_rate(const Sampler& sampler, const view::View& view, tbb::task_arena& arena,
                                  const std::stop_token& stop);

}  // namespace tessera::tools::bench
