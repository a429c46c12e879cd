#pragma once

#include "tests/bench/filters/scene_bench.h"

namespace tessera::tools::bench {

// Times of filters at the sizes of their publications, and of their methods. Empty: stopped.
std::optional<SpeedResult> measure_speed(const BenchScene& scene, const BenchPlan& plan,
                                         tbb::task_arena& arena, const BenchProgress& progress,
                                         const std::stop_token& stop);

// Every value but the standard one of the filter's parameters that choose among methods (except on/off
// switches).
std::vector<filter::Choice> variants(const filter::Choice& choice);

}  // namespace tessera::tools::bench
