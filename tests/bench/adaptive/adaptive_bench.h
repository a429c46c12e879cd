#pragma once

#include <tbb/task_arena.h>

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "client/tools/values.h"
#include "mediator/filter/choice.h"
#include "tests/bench/filters/scene_bench.h"

namespace tessera::tools::bench {

// Compares samples where they are needed with the same number of uniform ones.
struct AdaptivePlan {
    std::filesystem::path assets, references;
    std::vector<std::string> scenes;
    std::vector<std::uint64_t> spp;        // means to compare at
    std::vector<double> noise;             // to stop at
    std::vector<double> errors;            // likewise; of the pictures of the filter
    std::optional<filter::Choice> filter;  // whose pictures are compared; none: unfiltered ones
    Size size;
    std::uint32_t seeds = 0, jobs = 1;
    std::uint64_t reference_spp = 4096;
};

// Some films of one scene.
struct AdaptiveRow {
    double noise = 0.0;  // that was asked for; 0: another or a mean number of samples
    double error = 0.0;  // likewise
    double spp = 0.0;    // mean per pixel
    // relMSE of uniform samples over that of adaptive ones, each its mean over the seeds; of all pixels and without the
    // one in a thousand with the largest errors.
    double gain = 0.0, trimmed_gain = 0.0;
    double light = 0.0;  // mean luminance over that of uniform samples
    // Noise of the unfiltered picture of each seed, over that which was asked for, or, without, over the estimate.
    std::vector<double> true_noise;
    // relMSE of the filtered picture of each seed over that which was asked for, and over the estimate.
    std::vector<double> true_error, estimated_error;
    double deciding = 0.0;  // part of the time that decisions take
    double steps = 0.0;
};

struct AdaptiveScene {
    std::string name;
    double masked_rate = 0.0;  // see masked_rate()
    std::vector<AdaptiveRow> rows;
};

// Nothing when it was stopped.
std::optional<AdaptiveScene> measure_adaptive(const BenchScene& scene, const AdaptivePlan& plan,
                                              tbb::task_arena& arena, const BenchProgress& progress,
                                              const std::stop_token& stop);

}  // namespace tessera::tools::bench
