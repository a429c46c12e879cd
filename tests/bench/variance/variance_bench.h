#pragma once

#include <tbb/task_arena.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "client/tools/values.h"
#include "tests/bench/filters/scene_bench.h"

namespace tessera::tools::bench {

// Compares the film's estimates of the variance of the mean with the true one, from films with different seeds.
struct VariancePlan {
    std::filesystem::path assets;
    std::vector<std::string> scenes;
    std::vector<std::uint64_t> spp;  // ascending
    Size size;
    std::uint32_t seeds = 0, jobs = 1;
};

// One scene at one number of samples. Ratios are of estimated to true variance, over all seeds.
struct VarianceRow {
    std::uint64_t spp = 0;
    // Blocks of 16 x 16 pixels with a relative error of at least 0.3 %: those with enough light to estimate it by, and those
    // whose light is too rare.
    std::uint32_t blocks = 0, rare_blocks = 0;
    double within_all = 0.0;  // fraction of all their ratios in [0.7, 2]
    // Without rare light:
    double within = 0.0;
    double smallest = 0.0, median = 0.0, largest = 0.0;
    double whole = 0.0;        // of the whole picture, mean over the seeds
    double independent = 0.0;  // the same by M2 / (n (n - 1))
};

struct VarianceScene {
    std::string name;
    std::vector<VarianceRow> rows;
};

// Nothing when it was stopped.
std::optional<VarianceScene> measure_variances(const BenchScene& scene, const VariancePlan& plan,
                                               tbb::task_arena& arena, const BenchProgress& progress,
                                               const std::stop_token& stop);

}  // namespace tessera::tools::bench
