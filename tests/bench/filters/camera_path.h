#pragma once

#include "tests/bench/filters/film_groups.h"
#include "tests/bench/filters/scene_bench.h"

namespace tessera::tools::bench {

struct PathBenchInput {
    const BenchScene& scene;
    const BenchPlan& plan;
    const Sampler& sampler;
    const std::vector<FilmGroup>& groups;
    tbb::task_arena& arena;
    const BenchProgress& progress;
    const std::stop_token& stop;
};

inline constexpr double DegreesPerView = 0.5;

// Temporal stability while the camera slowly orbits the scene (DegreesPerView per view about the vertical
// axis through the point at the median depth): each filter gets one film of few new samples per view and
// keeps its history, if it has one. At the plan's first size. Empty: stopped.
std::optional<PathResult> measure_path(const PathBenchInput& input);

}  // namespace tessera::tools::bench
