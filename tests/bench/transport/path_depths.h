#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <vector>

#include "tests/bench/filters/errors.h"
#include "tests/bench/filters/sampler.h"

namespace tessera::tools::bench {

// A film whose paths end after some bounces: compared with those of whole paths, it shows where noise and time come from.
struct PathDepth {
    std::uint32_t bounces = 0;
    double light = 0.0;    // mean luminance over that of the references
    double noise = 0.0;    // of two independent films: half their squared difference, weighted as relMSE
    double seconds = 0.0;  // of sampling one film
};

// After 0, 1 and 2 bounces, and of whole paths, which come last. Nothing when it was stopped.
std::optional<std::vector<PathDepth>> measure_depths(const Sampler& sampler, const view::View& view,
                                                     const ReferencePair& truth, std::uint64_t spp,
                                                     const std::stop_token& stop);

// Half the squared difference of two pictures of independent samples over the squared references, mean of all pixels and
// components.
double relative_noise(const frame::Image& first, const frame::Image& second, const ReferencePair& truth);

}  // namespace tessera::tools::bench
