#pragma once

#include <functional>
#include <optional>
#include <stop_token>

#include "tests/bench/backends/backends_plan.h"
#include "tests/bench/backends/backends_results.h"
#include "tests/bench/filters/scene_bench.h"

namespace tessera::tools::bench {

// Measures all targets, which take turns; calls `show` after each scene. Empty when stopped. Throws Error.
std::optional<BackendsResults> run_backends(const BackendsPlan& plan, const BenchProgress& progress,
                                            const std::function<void(const BackendsScene&)>& show,
                                            const std::stop_token& stop);

}  // namespace tessera::tools::bench
