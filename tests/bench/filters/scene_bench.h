#pragma once

#include <functional>
#include <optional>

#include "tests/bench/filters/plan.h"
#include "tests/bench/filters/references.h"
#include "tests/bench/filters/results.h"

namespace tessera::tools::bench {

struct BenchProgress {
    std::function<void(const std::string&)> say;   // what is going on, now
    std::function<void(const std::string&)> warn;  // what a person should know, once
};

// Everything that is measured on one scene. Nothing when it was stopped. Throws Error.
std::optional<SceneResult> measure_scene(const BenchScene& scene, const BenchPlan& plan,
                                         tbb::task_arena& arena, const BenchProgress& progress,
                                         const std::stop_token& stop);

}  // namespace tessera::tools::bench
