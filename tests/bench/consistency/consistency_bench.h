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

// Compares denoised pictures with unfiltered ones of the same samples, over several seeds.
struct ConsistencyPlan {
    std::filesystem::path assets, references;
    std::vector<std::string> scenes;
    std::vector<filter::Choice> filters;  // the first is `none`
    std::vector<std::uint64_t> spp;       // ascending
    std::uint64_t reference_spp = 0;
    Size size;
    std::uint32_t seeds = 0, jobs = 1;
};

// What a consistent denoiser promises.
inline constexpr double MostMeanRatio = 1.02, MostMeanRatioOfRareLight = 1.15;
inline constexpr double MostSingleRatio = 1.05, LeastSingleFraction = 0.95;
inline constexpr double MostRareLight = 0.01, MostEnergyChange = 0.01;
inline constexpr double LeastSlope = 0.95;  // relative to the unfiltered picture's, from so many samples on:
inline constexpr std::uint64_t SlopeFrom = 256;

// relMSE over that of `none`.
struct ErrorRatio {
    double mean = 0.0;    // of the means over the seeds
    double single = 0.0;  // fraction of the seeds with at most MostSingleRatio
};

// One denoiser with one number of samples.
struct ConsistencyCell {
    std::string filter;
    std::uint64_t spp = 0;
    ErrorRatio all, trimmed;
    double energy = 0.0;  // mean luminance over that of `none`
    double specks = 0.0, ssim = 0.0;
    double rare_light = 0.0;  // fraction of the picture's light that is rare at these samples
    bool has_rare_light() const { return rare_light > MostRareLight; }
};

struct ConsistencyScene {
    std::string name;
    std::vector<ConsistencyCell> cells;  // by samples, then by filter, with `none`
    // By filter: how fast the error falls from SlopeFrom samples to the most, relative to the unfiltered picture's (ratio of
    // the slopes of log relMSE). Empty without two such numbers.
    std::vector<std::pair<std::string, double>> slopes;
};

// What is not as promised, one line for each.
std::vector<std::string> broken_promises(const ConsistencyScene& scene);

// Nothing when it was stopped.
std::optional<ConsistencyScene> measure_consistency(const BenchScene& scene, const ConsistencyPlan& plan,
                                                    tbb::task_arena& arena, const BenchProgress& progress,
                                                    const std::stop_token& stop);

}  // namespace tessera::tools::bench
