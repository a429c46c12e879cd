#pragma once

#include "tests/bench/filters/scene_bench.h"

namespace tessera::tools::bench {

// All scenes of the plan. Nothing when it was stopped. Throws Error.
std::optional<BenchResults> run_bench(const BenchPlan& plan, const BenchProgress& progress,
                                      const std::stop_token& stop);

}  // namespace tessera::tools::bench
