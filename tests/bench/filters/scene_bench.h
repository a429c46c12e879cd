#pragma once

#include <functional>
#include <optional>

#include "tests/bench/filters/plan.h"
#include "tests/bench/filters/references.h"
#include "tests/bench/filters/results.h"

namespace tessera::tools::bench {

struct BenchProgress {
    std::function<void(const std::string&)> say;   // current activity, on the progress line
    std::function<void(const std::string&)> warn;  // warnings
};
inline const BenchProgress SilentProgress{[](const std::string&) {}, [](const std::string&) {}};

// All measurements on one scene. Empty when stopped. Throws Error.
std::optional<SceneResult> measure_scene(const BenchScene& scene, const BenchPlan& plan,
                                         tbb::task_arena& arena, const BenchProgress& progress,
                                         const std::stop_token& stop);

}  // namespace tessera::tools::bench
