#pragma once

#include "tests/bench/filters/scene_bench.h"

namespace tessera::tools::bench {

// How long filters take at the sizes that their sources quote, and what their methods cost. Nothing: stopped.
std::optional<SpeedResult> measure_speed(const BenchScene& scene, const BenchPlan& plan,
                                         tbb::task_arena& arena, const BenchProgress& progress,
                                         const std::stop_token& stop);

// Every value but the standard one of the filter's parameters that choose among methods (not on and off).
std::vector<filter::Choice> variants(const filter::Choice& choice);

}  // namespace tessera::tools::bench
