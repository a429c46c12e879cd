#pragma once

#include "tests/bench/filters/film_groups.h"
#include "tests/bench/filters/scene_bench.h"

namespace tessera::tools::bench {

struct PathBed {
    const BenchScene& scene;
    const BenchPlan& plan;
    const Sampler& sampler;
    const std::vector<FilmGroup>& groups;
    tbb::task_arena& arena;
    const BenchProgress& progress;
    const std::stop_token& stop;
};

inline constexpr double DegreesPerView = 0.5;

// How calm a picture stays while the camera goes slowly round what it looks at (DegreesPerView about the
// upright axis through the point at the median depth): each filter sees films of few samples, one per view,
// with new samples each, and keeps its history, if it has one. At the plan's first size. Nothing: stopped.
std::optional<PathResult> measure_path(const PathBed& bed);

}  // namespace tessera::tools::bench
